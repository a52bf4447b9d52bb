'use strict';
// Draws flights in 3-D at the time cursor of page.js, with three.js. Lengths in metres, z up.

// --- shapes ----------------------------------------------------------------------------------

const placed = (object, place, turn) => {
  object.position.set(...place);
  if (turn) object.quaternion.set(...turn);
  return object;
};

function surface([r, g, b, a], fade = 1) {
  const opacity = a * fade;
  return new THREE.MeshLambertMaterial({
    color: new THREE.Color(r, g, b), opacity, transparent: opacity < 1, depthWrite: opacity >= 1,
    side: opacity < 1 ? THREE.DoubleSide : THREE.FrontSide,
  });
}

// An arrow along x of length 1, to be scaled and turned
function arrow(material, thickness) {
  const group = new THREE.Group();
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(thickness / 2, thickness / 2, 0.75, 12), material);
  const tip = new THREE.Mesh(new THREE.ConeGeometry(1.4 * thickness, 0.25, 16), material);
  shaft.rotation.z = tip.rotation.z = -Math.PI / 2;
  shaft.position.x = 0.375;
  tip.position.x = 0.875;
  return group.add(shaft, tip);
}

function words(text, height, colour) {
  const canvas = document.createElement('canvas');
  const pen = canvas.getContext('2d');
  const font = '600 44px ' + getComputedStyle(document.body).fontFamily;
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 8;
  canvas.height = 60;
  pen.font = font;
  pen.fillStyle = colour;
  pen.fillText(text, 4, 45);
  const map = new THREE.CanvasTexture(canvas);
  map.minFilter = THREE.LinearFilter;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map, depthWrite: false }));
  sprite.scale.set(1.6 * height * canvas.width / canvas.height, 1.6 * height, 1);
  return sprite;
}

const makers = {
  EllipsoidShape: ({ place, size, colour, turn }, fade) => {
    const mesh = placed(new THREE.Mesh(new THREE.SphereGeometry(0.5, 48, 32), surface(colour, fade)), place, turn);
    mesh.scale.set(...size);
    return mesh;
  },
  BoxShape: ({ place, size, colour, turn }, fade) =>
    placed(new THREE.Mesh(new THREE.BoxGeometry(...size), surface(colour, fade)), place, turn),
  CylinderShape: ({ place, size, colour, turn, bottom, top }, fade) => {
    const geometry = new THREE.CylinderGeometry(top / 2, bottom / 2, 1, 32, 1, colour[3] < 0.5).rotateX(Math.PI / 2);
    const mesh = placed(new THREE.Mesh(geometry, surface(colour, fade)), place, turn);
    mesh.scale.set(...size);
    return mesh;
  },
  ArrowShape: ({ place, length, thickness, colour, turn }, fade) => {
    const group = placed(arrow(surface(colour, fade), thickness / length), place, turn);
    group.scale.setScalar(length);
    return group;
  },
  PolylineShape: ({ points, colour, pairs }) => {
    const [r, g, b, opacity] = colour;
    const geometry = new THREE.BufferGeometry().setFromPoints(points.map((point) => new THREE.Vector3(...point)));
    const material = new THREE.LineBasicMaterial({ color: new THREE.Color(r, g, b), opacity, transparent: opacity < 1 });
    return pairs ? new THREE.LineSegments(geometry, material) : new THREE.Line(geometry, material);
  },
  // Drawn again in each theme, see `paint`
  BillboardText: () => null,
};

function make(shapes, fade) {
  const group = new THREE.Group();
  shapes.map((shape) => makers[shape.kind](shape, fade)).filter(Boolean).forEach((object) => group.add(object));
  return group;
}

// Lines of a grid on the ground between two corners
function grid([left, right], [near, far], height, cell) {
  const points = [];
  for (let x = Math.ceil(left / cell) * cell; x <= right; x += cell) points.push(new THREE.Vector3(x, near, height), new THREE.Vector3(x, far, height));
  for (let y = Math.ceil(near / cell) * cell; y <= far; y += cell) points.push(new THREE.Vector3(left, y, height), new THREE.Vector3(right, y, height));
  const material = new THREE.LineBasicMaterial({ color: 0x8c96a5, transparent: true, opacity: 0.35 });
  return new THREE.LineSegments(new THREE.BufferGeometry().setFromPoints(points), material);
}

// A tube through the points of a path. Each step has as many indices, so a part of it is a range.
const SIDES = 6;
function tube(points, radius, colour, opacity) {
  const corners = [], faces = [];
  let [ahead, across] = [new THREE.Vector3(1, 0, 0), new THREE.Vector3(0, 1, 0)];
  const up = new THREE.Vector3(0, 0, 1);
  points.forEach((point, k) => {
    const step = new THREE.Vector3().subVectors(points[Math.min(k + 1, points.length - 1)], points[Math.max(k - 1, 0)]);
    if (step.length() > 1e-6) ahead = step.normalize();
    const side = new THREE.Vector3().crossVectors(up, ahead);
    if (side.length() > 1e-3) across = side.normalize();
    const other = new THREE.Vector3().crossVectors(ahead, across);
    for (let j = 0; j < SIDES; j += 1) {
      const angle = 2 * Math.PI * j / SIDES;
      const corner = point.clone().addScaledVector(across, radius * Math.cos(angle)).addScaledVector(other, radius * Math.sin(angle));
      corners.push(...corner.toArray().map((n) => (Number.isFinite(n) ? n : 0)));
    }
    if (k === 0) return;
    const gap = [point, points[k - 1]].some(({ x }) => !Number.isFinite(x));
    for (let j = 0; j < SIDES; j += 1) {
      const [a, b, c, d] = [(k - 1) * SIDES + j, (k - 1) * SIDES + (j + 1) % SIDES, k * SIDES + j, k * SIDES + (j + 1) % SIDES];
      faces.push(...(gap ? [a, a, a, a, a, a] : [a, b, c, b, d, c]));
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(corners, 3));
  geometry.setIndex(faces);
  const material = new THREE.MeshBasicMaterial({ color: colour, opacity, transparent: opacity < 1, side: THREE.DoubleSide, depthWrite: opacity >= 1 });
  const mesh = new THREE.Mesh(geometry, material);
  // Its bounds are not those of the part that is drawn
  mesh.frustumCulled = false;
  return mesh;
}

// --- one vehicle -----------------------------------------------------------------------------

const THRUST = [0.9, 0.35, 0.1, 1], BEARING = [0.95, 0.7, 0.1, 1], CONE = [0.95, 0.75, 0.1, 0.3], WIND = [0.2, 0.6, 0.55, 1];
const CALM = 0.02;  // m/s

class Flown {
  constructor(flight, reach) {
    this.flight = flight;
    this.reach = reach;
    this.tracks = Object.fromEntries(['position', 'turn', 'thrust', 'bearing', 'wind']
      .filter((name) => name in flight).map((name) => [name, flight[name].map(unpack)]));
    this.points = this.tracks.position[0].map((_, k) => new THREE.Vector3(...this.at('position', k)));
    this.root = new THREE.Group();
    this.body = make(flight.body ?? [], flight.ghost ? 0.55 : 1);
    this.radius = 0.035 * reach;
    this.behind = tube(this.points, this.radius, flight.colour, 1);
    this.ahead = tube(this.points, 0.6 * this.radius, flight.colour, 0.3);
    this.root.add(this.body, this.behind, this.ahead);
    this.rotors = flight.rotors.map(([place]) => {
      const one = placed(arrow(surface(THRUST), 0.08), place);
      this.body.add(one);
      return one;
    });
    this.sight = this.addSight();
    this.wind = arrow(surface(WIND), 0.06);
    this.wind.visible = false;
    this.root.add(this.wind);
  }

  addSight() {
    // The ray points along x; the cone has its tip at the origin and opens along x, radius 1 at 1
    const group = new THREE.Group();
    const ray = arrow(surface(BEARING), 0.012);
    const cone = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 40, 1, true).rotateZ(Math.PI / 2).translate(0.5, 0, 0), surface(CONE));
    group.add(ray, cone);
    group.rotation.order = 'ZYX';
    group.visible = false;
    this.body.add(group);
    this.cone = cone;
    return group;
  }

  at(name, k) { return this.tracks[name].map((column) => column[k]); }

  paint(colour) {
    this.behind.material.color.set(colour);
    this.ahead.material.color.set(colour);
    const own = new THREE.Color(colour);
    this.body.children.filter((part) => part.geometry?.type === 'SphereGeometry').forEach((hull) => {
      hull.material.color.set(0xd2d8e2).lerp(own, this.flight.ghost ? 0.6 : 0.25);
      hull.material.opacity = this.flight.ghost ? 0.35 : 0.55;
    });
  }

  show(k) {
    const point = this.points[k];
    const known = Number.isFinite(point.x);
    this.body.visible = known && this.flight.body !== null;
    const each = 6 * SIDES;
    this.behind.geometry.setDrawRange(0, k * each);
    this.ahead.geometry.setDrawRange(k * each, Infinity);
    this.wind.visible = false;
    if (!known) return;
    this.body.position.copy(point);
    this.body.quaternion.set(...this.at('turn', k));
    if (this.tracks.thrust) this.showThrust(this.at('thrust', k));
    if (this.tracks.bearing) this.showBearing(this.at('bearing', k));
    if (this.tracks.wind) this.showWind(point, this.at('wind', k));
  }

  showThrust(shares) {
    shares.forEach((share, j) => {
      const one = this.rotors[j];
      one.visible = Math.abs(share) > 0.005;
      if (!one.visible) return;
      const direction = new THREE.Vector3(...this.flight.rotors[j][1]).multiplyScalar(Math.sign(share));
      one.quaternion.setFromUnitVectors(new THREE.Vector3(1, 0, 0), direction);
      // The square root shows the small thrusts of a level flight too
      one.scale.setScalar(1.6 * this.reach * Math.sqrt(Math.abs(share)));
    });
  }

  showBearing([azimuth, elevation, across, up]) {
    this.sight.visible = Number.isFinite(azimuth);
    if (!this.sight.visible) return;
    this.sight.rotation.set(0, -elevation, azimuth, 'ZYX');
    this.sight.scale.setScalar(3 * this.reach);
    const wide = [across, up].map((sigma) => Math.tan(Math.min(sigma, 1.2)));
    this.cone.visible = wide.every((part) => part > 1e-4);
    this.cone.scale.set(1, wide[0], wide[1]);
  }

  showWind(point, wind) {
    const speed = Math.hypot(...wind);
    this.wind.visible = speed > CALM;
    if (!this.wind.visible) return;
    this.wind.position.copy(point).z += 1.3 * this.reach;
    this.wind.quaternion.setFromUnitVectors(new THREE.Vector3(1, 0, 0), new THREE.Vector3(...wind).divideScalar(speed));
    this.wind.scale.setScalar(speed * 2 * this.reach);
  }
}

// --- the view --------------------------------------------------------------------------------

const START = { azimuth: -125, elevation: 26, zoom: 1 };  // degrees; the camera looks from there

class Scene {
  constructor(place, data) {
    this.place = place;
    this.data = data;
    this.world = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(38, 1, 0.05, 5000);
    this.camera.up.set(0, 0, 1);
    this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    place.append(this.renderer.domElement);
    const sun = new THREE.DirectionalLight(0xffffff, 0.55);
    sun.position.set(-2, -3, 6);
    this.world.add(new THREE.HemisphereLight(0xffffff, 0x8890a0, 0.75), sun, make(data.standing));
    this.labels = new THREE.Group();
    this.world.add(this.labels);
    this.view = { ...START };
    this.k = 0;
    this.select(0);
    this.steer();
    new ResizeObserver(() => this.resize()).observe(place);
    this.resize();
  }

  select(number) {
    this.flown?.forEach((one) => this.world.remove(one.root));
    const shown = this.data.sets[number];
    this.times = shown.track.time;
    this.flown = shown.flights.map((flight) => new Flown(flight, this.data.reach));
    this.world.add(...this.flown.map((one) => one.root));
    this.measure();
    this.follow(this.data.follow ?? this.size > 16 * this.data.reach);
  }

  // The sphere around all paths and lamps, and a grid on the ground
  measure() {
    const box = new THREE.Box3();
    this.flown.forEach((one) => one.points.filter(({ x }) => Number.isFinite(x)).forEach((point) => box.expandByPoint(point)));
    const lamps = this.data.standing.filter(({ kind }) => kind === 'EllipsoidShape');
    lamps.forEach(({ place }) => box.expandByPoint(new THREE.Vector3(...place)));
    box.expandByScalar(this.data.reach);
    this.middle = box.getCenter(new THREE.Vector3());
    const { x, y } = box.getSize(new THREE.Vector3());
    this.size = box.getSize(new THREE.Vector3()).length() / 2;
    const floor = this.data.standing.find(({ kind }) => kind === 'BoxShape');
    const [wide, deep, middle, height] = floor
      ? [floor.size[0], floor.size[1], { x: floor.place[0], y: floor.place[1] }, 0.01]
      : [1.3 * x, 1.3 * y, this.middle, Math.min(0, box.min.z)];
    const cell = [0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500].find((size) => Math.max(wide, deep) / size <= 14) ?? 1000;
    if (this.grid) this.world.remove(this.grid);
    this.grid = grid([middle.x - wide / 2, middle.x + wide / 2], [middle.y - deep / 2, middle.y + deep / 2], height, cell);
    this.world.add(this.grid);
  }

  follow(wanted) {
    this.following = wanted;
    document.querySelectorAll('.scene-buttons button').forEach((button) => {
      button.setAttribute('aria-pressed', String((button.dataset.view === 'follow') === wanted));
    });
    this.draw();
  }

  paint(theme) {
    const shade = (colour) => (theme === 'dark' ? dark[colour] ?? colour : colour);
    this.flown.forEach((one) => one.paint(shade(one.flight.colour)));
    document.querySelectorAll('.scene-names i').forEach((key) => key.style.setProperty('--light', shade(key.dataset.colour)));
    const ink = getComputedStyle(document.documentElement).getPropertyValue('--ink');
    this.labels.clear();
    const texts = this.data.standing.filter(({ kind }) => kind === 'BillboardText');
    texts.forEach(({ place, text, height }) => this.labels.add(placed(words(text, Math.max(height, this.size / 40), ink), place)));
    // At once: a print does not wait for the next frame
    this.render();
  }

  show(time) {
    const { times } = this;
    let k = times.findIndex((each) => each >= time);
    if (k < 0) k = times.length - 1;
    if (k > 0 && time - times[k - 1] < times[k] - time) k -= 1;
    this.k = k;
    this.flown.forEach((one) => one.show(Math.min(k, one.points.length - 1)));
    this.draw();
  }

  aim() {
    const { azimuth, elevation, zoom } = this.view;
    const here = this.flown.map((one) => one.points[Math.min(this.k, one.points.length - 1)]).find(({ x }) => Number.isFinite(x));
    const target = this.following && here ? here : this.middle;
    const radius = this.following ? 4 * this.data.reach : this.size;
    const half = THREE.MathUtils.degToRad(this.camera.fov / 2);
    // The narrower of both angles of view decides
    const angle = Math.min(half, Math.atan(Math.tan(half) * this.camera.aspect));
    const distance = 0.75 * radius / Math.sin(angle) / zoom;
    const [a, e] = [azimuth, elevation].map(THREE.MathUtils.degToRad);
    this.camera.position.set(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)).multiplyScalar(distance).add(target);
    this.camera.lookAt(target);
  }

  draw() {
    if (this.waiting) return;
    this.waiting = requestAnimationFrame(() => this.render());
  }

  render() {
    this.waiting = 0;
    this.aim();
    this.renderer.render(this.world, this.camera);
    this.place.dataset.drawn = String(this.k);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !height) return;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(width, height, false);
    this.render();
  }

  orbit(across, up) {
    this.view.azimuth -= across;
    this.view.elevation = Math.min(Math.max(this.view.elevation + up, -5), 89);
    this.draw();
  }

  zoom(factor) {
    this.view.zoom = Math.min(Math.max(this.view.zoom * factor, 0.3), 12);
    this.draw();
  }

  steer() {
    const { place } = this;
    let from = null;
    place.addEventListener('pointerdown', (event) => { from = event; place.setPointerCapture(event.pointerId); });
    place.addEventListener('pointermove', (event) => {
      if (!from) return;
      this.orbit(0.4 * (event.clientX - from.clientX), 0.4 * (event.clientY - from.clientY));
      from = event;
    });
    ['pointerup', 'pointercancel'].forEach((name) => place.addEventListener(name, () => { from = null; }));
    // The wheel scrolls the page until the view has the focus
    place.addEventListener('wheel', (event) => {
      if (document.activeElement !== place) return;
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY / 600));
    }, { passive: false });
    place.addEventListener('keydown', (event) => {
      const turns = { ArrowLeft: [-6, 0], ArrowRight: [6, 0], ArrowUp: [0, 4], ArrowDown: [0, -4] };
      const vertical = event.key === 'ArrowUp' || event.key === 'ArrowDown';
      if (turns[event.key] && (event.shiftKey || vertical)) this.orbit(...turns[event.key]);
      else if (event.key === '+' || event.key === '=') this.zoom(1.2);
      else if (event.key === '-') this.zoom(1 / 1.2);
      else if (event.key === '0') { this.view = { ...START }; this.draw(); } else return;
      event.preventDefault();
      event.stopPropagation();
    });
    document.querySelectorAll('.scene-buttons button').forEach((button) => {
      button.addEventListener('click', () => this.follow(button.dataset.view === 'follow'));
    });
  }
}

function hasWebGL() {
  const canvas = document.createElement('canvas');
  return Boolean(canvas.getContext('webgl2') ?? canvas.getContext('webgl'));
}

function addScene() {
  const place = document.querySelector('.scene');
  if (!place) return null;
  if (!window.THREE || !hasWebGL()) {
    document.querySelectorAll('.scene, .scene-names, .scene-buttons, .scene-panel figcaption').forEach((part) => { part.hidden = true; });
    document.querySelector('.scene-absent').hidden = false;
    return null;
  }
  return new Scene(place, json('scene'));
}

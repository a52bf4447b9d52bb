'use strict';
// Draws the figures, marks the same time in all of them, and switches the theme.
const element = (plot) => document.getElementById('figure-' + plot.dataset.panel);
const json = (id) => JSON.parse(document.getElementById(id).textContent);
const dark = json('dark');
let track = json('track');
const plots = [...document.querySelectorAll('.plot')];
const timed = plots.filter((plot) => plot.dataset.timed === 'true');
// Figures that are compressed follow in start()
const figures = new Map(plots.filter((plot) => !element(plot).dataset.size).map((plot) => [plot, json('figure-' + plot.dataset.panel)]));
const config = { displayModeBar: false, responsive: true, doubleClick: 'reset' };
const touch = matchMedia('(pointer: coarse)').matches;
let scene = null;

// --- data ------------------------------------------------------------------------------------

const ALPHABET = '0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;<=>?@^_`{|}~';

// Base 85: five characters for four bytes
function decode85(text, size) {
  const value = new Uint8Array(128);
  [...ALPHABET].forEach((character, k) => { value[character.charCodeAt(0)] = k; });
  const bytes = new DataView(new ArrayBuffer(text.length / 5 * 4));
  for (let k = 0; k < text.length; k += 5) {
    let word = 0;
    for (let j = 0; j < 5; j += 1) word = word * 85 + value[text.charCodeAt(k + j)];
    bytes.setUint32(k / 5 * 4, word);
  }
  return new Uint8Array(bytes.buffer, 0, size);
}

// Text that the page holds compressed
function inflate(packed) {
  const data = decode85(packed.textContent, Number(packed.dataset.size));
  packed.remove();
  return new Response(new Blob([data]).stream().pipeThrough(new DecompressionStream('deflate'))).text();
}

async function load(name) {
  const packed = document.getElementById(name);
  if (!packed) return;
  const script = document.createElement('script');
  script.textContent = await inflate(packed);
  document.head.append(script);
}

async function loadFigure(plot) {
  const packed = element(plot);
  if (packed?.dataset.size) figures.set(plot, JSON.parse(await inflate(packed)));
}

// 16-bit integers times a scale, the least of them unknown
function unpack({ scale, data }) {
  const bytes = Uint8Array.from(atob(data), (character) => character.charCodeAt(0));
  return Array.from(new Int16Array(bytes.buffer), (number) => (number === -32768 ? NaN : number * scale));
}

// --- theme -----------------------------------------------------------------------------------

function recoloured(value) {
  if (typeof value === 'string') return dark[value] ?? value.replace(/#[0-9a-f]{6}/g, (colour) => dark[colour] ?? colour);
  if (Array.isArray(value)) return value.map(recoloured);
  if (value === null || typeof value !== 'object' || 'bdata' in value) return value;
  return Object.fromEntries(Object.entries(value).map(([key, part]) => [key, recoloured(part)]));
}

function draw(theme) {
  document.documentElement.dataset.theme = theme;
  const button = document.getElementById('theme');
  button.setAttribute('aria-pressed', String(theme === 'dark'));
  button.textContent = theme === 'dark' ? 'Light' : 'Dark';
  return Promise.all(plots.map((plot) => {
    const figure = structuredClone(figures.get(plot));
    const { data, layout } = theme === 'dark' ? recoloured(figure) : figure;
    if (touch) layout.dragmode = false;
    return Plotly.react(plot, data, layout, config).then(fitHeight);
  })).then(() => { scene?.paint(theme); mark(now); });
}

// A map with equal scales is lower than its place if the page is narrow
function fitHeight(plot) {
  const { _size: size, yaxis, yaxis2 } = plot._fullLayout;
  const spare = yaxis?.constrain === 'domain' && yaxis.scaleanchor && !yaxis2 ? size.h - yaxis._length : 0;
  if (spare < 20) return plot;
  plot.style.height = plot.clientHeight - spare + 'px';
  return Plotly.Plots.resize(plot);
}

// --- cursor in all figures -------------------------------------------------------------------

let times = track.time ?? [];
const slider = document.getElementById('time');
const cells = [...document.querySelectorAll('#readout dd')];
let now = track.start?.[0] ?? 0;

function at(time) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle; else high = middle;
  }
  return time - times[low] < times[high] - time ? low : high;
}

function cursor(plot) {
  let line = plot.querySelector(':scope > .cursor');
  if (!line) {
    line = document.createElement('div');
    line.className = 'cursor';
    plot.append(line);
  }
  return line;
}

function markPlot(plot) {
  const { _size: size, xaxis } = plot._fullLayout;
  const across = xaxis.d2p(now);
  Object.assign(cursor(plot).style, {
    display: across < 0 || across > size.w ? 'none' : 'block',
    left: size.l + across + 'px', top: size.t + 'px', height: size.h + 'px',
  });
}

function markPath(plot, k) {
  let svg = plot.querySelector(':scope > .drone');
  if (!svg) {
    plot.insertAdjacentHTML('beforeend', '<svg class="drone" aria-hidden="true"><line class="ray"/>'
      + '<circle class="hull"/><path class="nose"/></svg>');
    svg = plot.querySelector(':scope > .drone');
  }
  const { xaxis, yaxis } = plot._fullLayout;
  const pixels = (x, y) => [xaxis._offset + xaxis.d2p(x), yaxis._offset + yaxis.d2p(y)];
  const [x, y, yaw, bearing] = ['x', 'y', 'yaw', 'bearing'].map((name) => track[name]?.[k] ?? null);
  const [cx, cy] = pixels(x, y);
  const radius = xaxis.d2p(x + track.radius[0]) - xaxis.d2p(x);
  const [hull, nose, ray] = ['.hull', '.nose', '.ray'].map((name) => svg.querySelector(name));
  hull.setAttribute('cx', cx); hull.setAttribute('cy', cy); hull.setAttribute('r', radius);
  const point = (angle, part) => [cx + part * radius * Math.cos(angle), cy - part * radius * Math.sin(angle)];
  nose.setAttribute('d', 'M' + [point(yaw, 0.85), point(yaw + 0.35, 0.5), point(yaw - 0.35, 0.5)].join('L') + 'Z');
  ray.style.display = bearing === null ? 'none' : 'inline';
  if (bearing !== null) {
    const [from, to] = [point(yaw + bearing, 1), pixels(x + 1.6 * Math.cos(yaw + bearing), y + 1.6 * Math.sin(yaw + bearing))];
    ray.setAttribute('x1', from[0]); ray.setAttribute('y1', from[1]);
    ray.setAttribute('x2', to[0]); ray.setAttribute('y2', to[1]);
  }
}

function mark(time) {
  if (!times.length) return;
  now = Math.min(Math.max(time, times[0]), times[times.length - 1]);
  const k = at(now);
  timed.forEach(markPlot);
  scene?.show(now);
  if (track.radius) plots.filter((plot) => plot.dataset.panel === 'path').forEach((plot) => markPath(plot, k));
  for (const cell of cells) {
    const value = track[cell.dataset.value]?.[k] ?? null;
    const factor = Number(cell.dataset.factor ?? 1);
    cell.textContent = value === null ? '–' : (value * factor).toFixed(cell.dataset.digits).replace('-', '−') + cell.dataset.unit;
  }
  slider.value = now;
  slider.setAttribute('aria-valuetext', cells.map((cell) => cell.previousElementSibling.textContent + ' ' + cell.textContent).join(', '));
}

// Replays another flight from here on
function useTrack(next) {
  track = next;
  times = track.time;
  Object.assign(slider, { min: times[0], max: times[times.length - 1], step: 0.05 });
  mark(times[Math.floor(times.length / 2)]);
}

function stepByKeys(event) {
  const across = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  const free = event.target === document.body || event.target.classList.contains('scene');
  if (!across || !free || event.shiftKey || event.altKey || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  setPlaying(false);
  mark(now + across * (times[times.length - 1] - times[0]) / 150);
}

function follow(plot) {
  plot.addEventListener('mousemove', (event) => {
    if (playing) return;
    const { _size: size, xaxis } = plot._fullLayout;
    const across = event.clientX - plot.getBoundingClientRect().left - size.l;
    if (across >= 0 && across <= size.w) mark(xaxis.p2d(across));
  });
  plot.on('plotly_relayout', (change) => {
    const key = Object.keys(change).find((name) => /^xaxis\d*\.(range\[0\]|range|autorange)$/.test(name));
    if (key && !zooming) zoom(plot._fullLayout.xaxis.range.slice());
  });
}

let zooming = false;
async function zoom(range) {
  zooming = true;
  await Promise.all(timed.map((plot) => {
    const axes = Object.keys(plot._fullLayout).filter((name) => /^xaxis\d*$/.test(name));
    return Plotly.relayout(plot, Object.fromEntries(axes.map((name) => [name + '.range', range.slice()])));
  }));
  zooming = false;
  mark(now);
}

// --- replay ----------------------------------------------------------------------------------

const play = document.getElementById('play');
let playing = false;

function setPlaying(wanted) {
  playing = wanted;
  play.textContent = playing ? '❚❚' : '▶\ufe0e';
  play.setAttribute('aria-label', playing ? 'Pause' : 'Play the flight');
  if (!playing) return;
  const last = times[times.length - 1];
  if (now >= last) mark(times[0]);
  // A day takes a quarter of a minute, a flight its own time
  const pace = Math.max(1, (last - times[0]) / 15) * Number(document.getElementById('pace').value);
  let before = performance.now();
  // Two pictures a second for readers who prefer little motion
  const calm = matchMedia('(prefers-reduced-motion: reduce)').matches;
  const later = calm ? (show) => setTimeout(() => show(performance.now()), 500) : requestAnimationFrame;
  const step = (instant) => {
    if (!playing) return;
    mark(now + pace * (instant - before) / 1000);
    before = instant;
    if (now >= last) setPlaying(false); else later(step);
  };
  later(step);
}

async function start() {
  await Promise.all([...['plotly', 'three'].map(load), ...plots.map(loadFigure)]);
  scene = typeof addScene === 'function' ? addScene() : null;
  const prefers = matchMedia('(prefers-color-scheme: dark)');
  const theme = () => document.documentElement.dataset.theme;
  document.getElementById('theme').addEventListener('click', () => draw(theme() === 'dark' ? 'light' : 'dark'));
  prefers.addEventListener('change', () => draw(prefers.matches ? 'dark' : 'light'));
  let before = null;
  addEventListener('beforeprint', () => { before = theme(); draw('light'); });
  addEventListener('afterprint', () => { if (before) draw(before); });
  addEventListener('resize', () => requestAnimationFrame(() => mark(now)));
  if (times.length) {
    Object.assign(slider, { min: times[0], max: times[times.length - 1], step: 0.05 });
    slider.addEventListener('input', () => { setPlaying(false); mark(Number(slider.value)); });
    play.addEventListener('click', () => setPlaying(!playing));
    document.getElementById('pace').addEventListener('change', () => { if (playing) { setPlaying(false); setPlaying(true); } });
    document.getElementById('bar').hidden = false;
    document.addEventListener('keydown', stepByKeys);
  }
  return draw(prefers.matches ? 'dark' : 'light').then(() => {
    timed.forEach(follow);
    plots.forEach((plot) => plot.on('plotly_afterplot', () => mark(now)));
    document.documentElement.dataset.drawn = String(plots.length);
  });
}

start();

// Returns the pairs of labels that overprint each other, in figures and in tables, and labels that
// are cut off. A line of text is lower than its box, so boxes count without part of their height.
(() => {
  const found = [];
  const inner = ({ left, right, top, bottom }) => {
    const air = Math.min(0.22 * (bottom - top), 4);
    return { left: left + 1, right: right - 1, top: top + air, bottom: bottom - air };
  };
  const overlaps = (a, b) => Math.min(a.right, b.right) > Math.max(a.left, b.left)
    && Math.min(a.bottom, b.bottom) > Math.max(a.top, b.top);
  const compare = (place, labels) => labels.forEach((one, k) => labels.slice(k + 1).forEach((other) => {
    if (overlaps(one.box, other.box)) found.push(`${place}: '${one.text}' over '${other.text}'`);
  }));
  const seen = (element) => element.checkVisibility({ opacityProperty: true, visibilityProperty: true });
  for (const drawing of document.querySelectorAll('.plot, svg.views')) {
    const texts = [...drawing.querySelectorAll('text')].filter((text) =>
      text.textContent.trim() && seen(text) && !text.closest('.hoverlayer, defs'));
    const labels = texts.map((text) => ({ text: text.textContent.trim(), box: inner(text.getBoundingClientRect()) }));
    const name = drawing.dataset.panel ?? 'drawing';
    compare(name, labels);
    const { left, right, top, bottom } = drawing.getBoundingClientRect();
    if (drawing.matches('.plot')) labels.filter(({ box }) => box.left < left - 2 || box.right > right + 2 || box.top < top - 2 || box.bottom > bottom + 2)
      .forEach(({ text }) => found.push(`${name}: '${text}' is cut off`));
  }
  for (const table of document.querySelectorAll('table, .tiles')) {
    if (!seen(table)) continue;
    const labels = [...table.querySelectorAll('th, td, dt, dd')].filter((cell) => cell.textContent.trim() && seen(cell)
      && !cell.closest('.hidden')).map((cell) => {
      const range = document.createRange();
      range.selectNodeContents(cell);
      const { left, right, top, bottom } = range.getBoundingClientRect();
      return { text: cell.textContent.trim().slice(0, 40), box: { left: left + 1, right: right - 1, top: top + 2, bottom: bottom - 2 } };
    });
    // Cells overlap their neighbours; a sticky head covers the rows below on purpose
    if (getComputedStyle(table.querySelector('th') ?? table).position !== 'sticky') compare('table', labels);
  }
  return found;
})()

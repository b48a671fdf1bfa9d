/* The legends of the colours: those of the page, and the same on pictures. */

/* The channels that colour something that is shown. */
function shownChannels() {
  const shown = (surfaces) => meta.bodies.some((b) => b.shown && !b.triangles !== surfaces);
  return [...new Set([shown(false) && settings.fluid, shown(true) && settings.surface])].filter((name) => name in channels);
}

/* Name and unit of a channel, and the values at both ends of its colours. */
function legendTexts(name) {
  const { label, unit, factor, map } = channels[name], { top, most } = ranges[name], diverges = map === "vik";
  const over = most > 1.001 * top;
  return {
    title: `${label[0].toUpperCase()}${label.slice(1)} (${unit})`,
    low: diverges ? (over ? "≤ " : "") + formatNumber(-factor * top) : "0",
    high: (over ? "≥ " : "") + formatNumber(factor * top),
  };
}

/* A strip of the colours of a channel, 256 x 1 pixels. */
function legendStrip(name) {
  const strip = Object.assign(document.createElement("canvas"), { width: 256, height: 1 });
  strip.getContext("2d").putImageData(new ImageData(mapTexels(maps[channels[name].map]), 256, 1), 0, 0);
  return strip;
}

function showLegends() {
  $("legends").replaceChildren();
  for (const name of shownChannels()) {
    const { title, low, high } = legendTexts(name), figure = element($("legends"), "figure");
    element(figure, "span", { textContent: title });
    figure.append(legendStrip(name));
    const ends = element(figure, "div");
    for (const textContent of [low, high]) element(ends, "span", { textContent });
  }
}

/* Draws the legends into the upper right corner of a picture. em: height of the text, a 36th of the picture's, at least 9
 * pixels where the picture is wide enough */
function drawLegends(context) {
  const { width, height } = context.canvas, em = Math.min(Math.max(9, height / 36), width / 20), names = shownChannels();
  context.font = `${em}px sans-serif`;
  context.textBaseline = "middle";
  const wide = Math.max(11 * em, ...names.map((name) => context.measureText(legendTexts(name).title).width));
  names.forEach((name, k) => drawLegend(context, name, em, width - 1.7 * em - wide, wide, (1 + 5 * k) * em));
}

/* Draws the legend of a channel. x, y: left end of its strip, upper edge of its panel; wide: of the strip; pixels */
function drawLegend(context, name, em, x, wide, y) {
  const { title, low, high } = legendTexts(name);
  context.fillStyle = "rgb(251 252 253 / .9)";
  context.fillRect(x - 0.7 * em, y, wide + 1.4 * em, 4.5 * em);
  context.fillStyle = "#1d2530";
  context.textAlign = "left";
  context.fillText(title, x, y + 1.1 * em);
  context.fillText(low, x, y + 3.6 * em);
  context.textAlign = "right";
  context.fillText(high, x + wide, y + 3.6 * em);
  context.drawImage(legendStrip(name), x, y + 1.9 * em, wide, 0.9 * em);
}

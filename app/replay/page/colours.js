/* Colours: maps that are perceptually uniform and safe for colour-blind readers, and the palette of bodies. */

/* Equally spaced colours: the upper part of mako, viridis, cividis; vik diverges from white in its middle. */
const maps = {
  mako: ["3c518d", "37659e", "367aa4", "348fa7", "3aa3aa", "40b7ad", "66c9b0", "8bdab2", "b5e8cc", "def5e5"],
  viridis: ["472d7b", "3b528b", "2c728e", "21918c", "28ae80", "5ec962", "addc30", "fde725"],
  cividis: ["00224e", "123570", "3b496c", "575d6d", "707173", "8a8678", "a59c74", "c3b369", "e1cc55", "fee838"],
  vik: ["001261", "033e7d", "1e6f9d", "71a8c4", "c9dde7", "eacebd", "d39774", "be6533", "8b2706", "590007"],
};

/* Colours of sheets, of bodies with a volume and particles that are no fluid, and of the particles of several fluids,
 * sRGB, for parts without a colour of their own. */
const palette = {
  sheet: ["e0c9a4", "d98e73", "a9b79a", "c3a3b5"], solid: ["c4553b", "d9a04a", "7c5c86", "6f8f5a"],
  liquid: ["3d8fb5", "d9a93a", "9c3350"],
};
const clay = "bdb7ae";

const channels = {
  speed: { label: "speed", unit: "m/s", factor: 1, map: "mako" },
  error: { label: "density error", unit: "%", factor: 100, map: "viridis" },
  pressure: { label: "pressure", unit: "Pa", factor: 1, map: "cividis" },
  stretch: { label: "stretch since frame 0", unit: "%", factor: 100, map: "vik" },
};

const hexBytes = (hex) => [0, 2, 4].map((k) => parseInt(hex.slice(k, k + 2), 16));

/* Linear light of a colour, for the shaders, which take the gamma as 2. */
const linearColour = (hex) => hexBytes(hex).map((v) => (v / 255) ** 2);

/* The colour of a part, or `other` */
const ownColour = (part, other) => linearColour(part.color ? part.color.slice(1) : other);

/* What the liquids of `palette` absorb, per length "clear" (water.js), and scatter: water, oil, wine. */
const liquids = [
  { absorbed: [2.2, 0.75, 0.45], scattered: [0.012, 0.11, 0.19] },
  { absorbed: [0.5, 1.1, 4.0], scattered: [0.42, 0.25, 0.02] },
  { absorbed: [0.9, 3.2, 2.2], scattered: [0.22, 0.015, 0.04] },
];

/* The same for a colour, in linear light, so that it looks like those above. */
function liquidOf(colour) {
  return { absorbed: colour.map((c) => -1.2 * Math.log(Math.max(c, 0.02))), scattered: colour.map((c) => 0.5 * c) };
}

/* The uniforms `absorbed`, `scattered` and `isWater` of the shaders: three liquids. parts: the fluids */
function liquidLooks(parts) {
  const looks = liquids.map((look, k) => parts[k]?.color ? liquidOf(ownColour(parts[k])) : look);
  return {
    absorbed: looks.flatMap((look) => look.absorbed), scattered: looks.flatMap((look) => look.scattered),
    isWater: looks[0] === liquids[0] ? 1 : 0,
  };
}

/* 256 RGBA texels, interpolated between the equally spaced colours of a map. */
function mapTexels(colours) {
  const texels = new Uint8ClampedArray(1024), rgb = colours.map(hexBytes);
  for (let i = 0; i < 256; i++) {
    const place = i / 255 * (rgb.length - 1), k = Math.min(rgb.length - 2, Math.floor(place));
    for (let c = 0; c < 3; c++) texels[4 * i + c] = Math.round(rgb[k][c] + (place - k) * (rgb[k + 1][c] - rgb[k][c]));
    texels[4 * i + 3] = 255;
  }
  return texels;
}

// The overlay: tinted objects with outlines, as in the overlay video, and outlines of rejected proposals.

const TINT = 0.45;
const LONGEST = 24; // characters of a name in the picture
const scratch = document.createElement("canvas");

const levels = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));

// Colours by identity: red, green and blue, 0 to 255.
export const readColours = (objects) => new Map(objects.map(({ identity, colour }) => [identity, levels(colour)]));

const isBorder = (labels, at, x, y, width, height) => {
  const label = labels[at];
  return (
    (x > 0 && labels[at - 1] !== label) ||
    (x + 1 < width && labels[at + 1] !== label) ||
    (y > 0 && labels[at - width] !== label) ||
    (y + 1 < height && labels[at + width] !== label)
  );
};

// Draws labels over what the context shows. `lineOnly` leaves areas untouched.
export const drawLabels = (context, labels, width, height, colours, { selected, opacity, lineOnly = false }) => {
  scratch.width = width;
  scratch.height = height;
  const inner = scratch.getContext("2d");
  const image = inner.createImageData(width, height);
  const out = image.data;
  const area = Math.round(255 * TINT * opacity);
  for (let y = 0, at = 0; y < height; y += 1) {
    for (let x = 0; x < width; x += 1, at += 1) {
      const label = labels[at];
      const isEdge = isBorder(labels, at, x, y, width, height);
      if (!label && !isEdge) continue;
      const to = 4 * at;
      const colour = colours.get(label);
      if (label && colour) {
        const isChosen = selected.has(label);
        const [red, green, blue] = isEdge && isChosen ? [255, 255, 255] : colour;
        out[to] = red;
        out[to + 1] = green;
        out[to + 2] = blue;
        if (isEdge) out[to + 3] = 255;
        else if (!lineOnly) out[to + 3] = isChosen ? Math.min(255, area * 1.4) : area;
      } else if (isEdge && !lineOnly) {
        // The dark rim around an object, by which its line is visible on its own colour.
        out[to + 3] = 150;
      }
    }
  }
  inner.putImageData(image, 0, 0);
  context.drawImage(scratch, 0, 0);
};

const shorten = (text) => {
  const characters = [...text];
  return characters.length > LONGEST ? `${characters.slice(0, LONGEST - 1).join("")}…` : text;
};

// Writes the name of each object at the mean of its pixels, or above an object that is hardly larger than its name.
export const drawNames = (context, labels, width, names) => {
  const sums = new Map();
  for (let at = 0; at < labels.length; at += 1) {
    const label = labels[at];
    if (!label) continue;
    const sum = sums.get(label) ?? [0, 0, 0, (at - (at % width)) / width];
    sum[0] += 1;
    sum[1] += at % width;
    sum[2] += (at - (at % width)) / width;
    sums.set(label, sum);
  }
  const size = Math.max(11, Math.round(width / 40));
  context.font = `600 ${size}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineJoin = "round";
  for (const [label, [count, x, y, top]] of sums) {
    const text = shorten(names.get(label) ?? String(label));
    const isSmall = count < 9 * size * size;
    // Within the frame as a whole.
    const half = context.measureText(text).width / 2 + size / 4;
    const column = Math.max(Math.min(x / count, width - half), half);
    const place = [column, isSmall ? Math.max(top - 0.8 * size, 0.6 * size) : y / count];
    context.lineWidth = size / 4;
    context.strokeStyle = "rgb(0 0 0 / 80%)";
    context.strokeText(text, ...place);
    context.fillStyle = "#fff";
    context.fillText(text, ...place);
  }
};

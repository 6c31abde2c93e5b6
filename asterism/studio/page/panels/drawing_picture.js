// A small picture of a drawing: rods dark, the outline in the accent colour, what is left out faint.

const MARGIN_PX = 24;

export function pictureOf(canvas, layers, [width, height]) {
  const context = canvas.getContext("2d");
  const styles = getComputedStyle(canvas);
  const colour = (name) => styles.getPropertyValue(`--${name}`).trim();
  const points = layers.flatMap(({ lines }) => lines.flat());
  const low = [0, 1].map((axis) => points.reduce((least, point) => Math.min(least, point[axis]), Infinity));
  const scale = Math.min(
    (canvas.width - 2 * MARGIN_PX) / Math.max(width, 1e-9),
    (canvas.height - 2 * MARGIN_PX) / Math.max(height, 1e-9),
  );
  const left = (canvas.width - scale * width) / 2;
  const bottom = (canvas.height + scale * height) / 2;
  const at = ([x, y]) => [left + scale * (x - low[0]), bottom - scale * (y - low[1])];
  context.clearRect(0, 0, canvas.width, canvas.height);
  context.lineCap = context.lineJoin = "round";
  const order = ["none", "rods", "both", "outline"];
  for (const { lines, use } of [...layers].sort((a, b) => order.indexOf(a.use) - order.indexOf(b.use))) {
    context.strokeStyle = colour({ none: "ink-soft", rods: "ink" }[use] ?? "accent");
    context.lineWidth = { none: 1, outline: 3 }[use] ?? 5;
    for (const line of lines) {
      context.beginPath();
      line.forEach((point, k) => context[k ? "lineTo" : "moveTo"](...at(point)));
      context.stroke();
    }
  }
}

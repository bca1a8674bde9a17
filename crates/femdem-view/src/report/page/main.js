// Starts the view; without WebGL the rest of the page stays as it is.

function start() {
  const canvas = document.getElementById("view");
  try {
    const view = new View(canvas, readPack());
    const panel = new Panel(view);
    new Gestures(view, (x, y) => panel.choose(view.pick(x, y)));
    new ResizeObserver(() => view.fits() || view.refresh()).observe(canvas);
    canvas.addEventListener("webglcontextlost", () => excuse("the graphics processor was lost; load the page again"));
    window.femdem = { view, panel };
  } catch (error) {
    excuse(error.message);
  }
}

function excuse(reason) {
  const note = document.getElementById("excuse");
  note.textContent = `The 3-D view cannot be shown: ${reason}. The plots and tables below do not need it.`;
  note.hidden = false;
  document.getElementById("stage").hidden = true;
}

start();

"use strict";

const clamp = (value, least, most) => Math.min(Math.max(value, least), most);
const MOST_ZOOM = 32;

// The part of all pictures of a scene that is seen: its left and top edges as shares of the picture, and how much larger.
function viewOf(scene) {
  const slider = scene.querySelector(".zoom");
  const said = scene.querySelector(".zoomed");
  let zoom = 1, x = 0, y = 0;
  const show = () => {
    x = clamp(x, 0, 1 - 1 / zoom);
    y = clamp(y, 0, 1 - 1 / zoom);
    scene.style.setProperty("--zoom", zoom);
    scene.style.setProperty("--x", x);
    scene.style.setProperty("--y", y);
    slider.value = Math.log2(zoom);
    said.value = `${Number(zoom.toFixed(1))}\u00d7`;
  };
  return {
    isWhole: () => zoom === 1,
    // The point at these shares of the pane stays where it is.
    zoomTo(wanted, atX = 0.5, atY = 0.5) {
      const next = clamp(wanted, 1, MOST_ZOOM);
      x += atX * (1 / zoom - 1 / next);
      y += atY * (1 / zoom - 1 / next);
      zoom = next;
      show();
    },
    zoomBy(factor, atX, atY) { this.zoomTo(zoom * factor, atX, atY); },
    // By shares of the pane.
    move(byX, byY) {
      x += byX / zoom;
      y += byY / zoom;
      show();
    },
  };
}

// Ours and theirs on top of each other: which is in front, and how much of it is seen.
function flipOf(comparison) {
  const pane = comparison.querySelector(".compare");
  const button = comparison.querySelector(".flip");
  const slider = comparison.querySelector(".split");
  const names = comparison.querySelector(".names");
  const show = () => {
    const turned = pane.classList.contains("turned");
    const [front, back] = turned ? ["theirs", "ours"] : ["ours", "theirs"];
    const split = Number(slider.value);
    pane.style.setProperty("--split", `${split}%`);
    pane.classList.toggle("divided", split > 0 && split < 100);
    button.setAttribute("aria-pressed", String(turned));
    names.value = split === 100 ? front : split === 0 ? back : `${front} | ${back}`;
  };
  const flip = () => {
    pane.classList.toggle("turned");
    show();
  };
  button.addEventListener("click", flip);
  slider.addEventListener("input", show);
  // Browsers may keep the slider's place when the page is loaded again.
  show();
  return flip;
}

function listen(pane, view, flip) {
  let dragged = false;
  pane.addEventListener("pointerdown", (down) => {
    dragged = false;
    if (down.button !== 0) return;
    let [lastX, lastY] = [down.clientX, down.clientY];
    const move = (event) => {
      dragged ||= Math.hypot(event.clientX - down.clientX, event.clientY - down.clientY) > 4;
      if (!dragged) return;
      view.move((lastX - event.clientX) / pane.clientWidth, (lastY - event.clientY) / pane.clientHeight);
      [lastX, lastY] = [event.clientX, event.clientY];
    };
    const end = () => {
      window.removeEventListener("pointermove", move);
      window.removeEventListener("pointerup", end);
      window.removeEventListener("pointercancel", end);
    };
    window.addEventListener("pointermove", move);
    window.addEventListener("pointerup", end);
    window.addEventListener("pointercancel", end);
  });
  pane.addEventListener("click", () => {
    if (flip && !dragged) flip();
    dragged = false;
  });
  pane.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    const box = pane.getBoundingClientRect();
    const [atX, atY] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    view.zoomBy(2 ** (-event.deltaY / 200), atX, atY);
  }, { passive: false });
  const moves = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] };
  pane.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    // Arrow keys scroll the page where there is nothing to move.
    if (moves[event.key] && !view.isWhole()) view.move(...moves[event.key]);
    else if (event.key === "+" || event.key === "=") view.zoomBy(2);
    else if (event.key === "-") view.zoomBy(0.5);
    else if (event.key === "0") view.zoomTo(1);
    else if (flip && (event.key === "Enter" || event.key === " ")) flip();
    else return;
    event.preventDefault();
  });
}

for (const scene of document.querySelectorAll(".scene")) {
  const slider = scene.querySelector(".zoom");
  if (!slider) continue;
  const view = viewOf(scene);
  slider.addEventListener("input", () => view.zoomTo(2 ** slider.value));
  scene.querySelector(".reset").addEventListener("click", () => view.zoomTo(1));
  view.zoomTo(1);
  for (const comparison of scene.querySelectorAll(".comparison")) {
    const pane = comparison.querySelector(".compare");
    if (pane) listen(pane, view, flipOf(comparison));
  }
  for (const pane of scene.querySelectorAll(".pane:not(.compare)")) listen(pane, view, null);
}


// With #selftest at the end of its address the page tries its own controls by the events of a user, looks at what is seen where,
// and writes what it finds below its last section.
function selfTest() {
  const findings = [];
  const check = (what, passed, seen) => findings.push(`${passed ? "ok" : "FAILED"}: ${what}${passed ? "" : `, seen ${seen}`}`);
  const equal = (what, seen, wanted) => check(what, seen === wanted, `${seen}, wanted ${wanted}`);
  const slide = (input, value) => {
    input.value = value;
    input.dispatchEvent(new Event("input", { bubbles: true }));
  };
  const press = (pane, key) => pane.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true, cancelable: true }));
  const pointer = (target, type, x, y) =>
    target.dispatchEvent(new PointerEvent(type, { clientX: x, clientY: y, button: 0, bubbles: true }));

  for (const scene of document.querySelectorAll(".scene")) {
    const images = [...scene.querySelectorAll(".pane img")];
    if (images.length === 0) continue;
    const name = scene.id;
    // Where each picture lies in its pane, in shares of the pane.
    const places = () => images.map((image) => {
      const [inner, outer] = [image, image.closest(".pane")].map((e) => e.getBoundingClientRect());
      const shares = [(inner.left - outer.left) / outer.width, (inner.top - outer.top) / outer.height, inner.width / outer.width];
      return shares.map((v) => v.toFixed(3)).join(" ");
    });
    const aligned = (what) => {
      const found = new Set(places());
      check(`${name}: pictures are aligned ${what}`, found.size === 1, [...found].join(" and "));
      return places()[0].split(" ").map(Number);
    };
    const height = scene.getBoundingClientRect().height;
    const still = (what) => equal(`${name}: nothing jumped ${what}`, scene.getBoundingClientRect().height, height);
    images.forEach((image) => check(`${name}: ${image.alt} is decoded`, image.complete && image.naturalWidth > 0, "nothing"));

    for (const comparison of scene.querySelectorAll(".comparison")) {
      const pane = comparison.querySelector(".compare");
      const [button, slider, names] = [".flip", ".split", ".names"].map((s) => comparison.querySelector(s));
      pane.scrollIntoView({ block: "center", behavior: "instant" });
      // Who is seen at this share of the width.
      const at = (share) => {
        const box = pane.getBoundingClientRect();
        const found = document.elementFromPoint(box.left + share * box.width, box.top + box.height / 2);
        return found?.closest(".layer")?.classList.contains("ours") ? "ours" : found?.closest(".layer") ? "theirs" : "nothing";
      };
      equal(`${name}: ours first`, `${at(0.25)} ${at(0.75)} ${names.value}`, "ours ours ours");
      pane.click();
      equal(`${name}: a click shows theirs`, `${at(0.25)} ${at(0.75)} ${names.value}`, "theirs theirs theirs");
      equal(`${name}: the button is pressed`, button.getAttribute("aria-pressed"), "true");
      pane.click();
      equal(`${name}: another click shows ours`, at(0.5), "ours");
      button.click();
      equal(`${name}: the button flips`, at(0.5), "theirs");
      press(pane, "Enter");
      equal(`${name}: Enter flips`, at(0.5), "ours");
      slide(slider, 50);
      equal(`${name}: split in the middle`, `${at(0.25)} ${at(0.75)} ${names.value}`, "ours theirs ours | theirs");
      slide(slider, 80);
      equal(`${name}: split at 80 %`, `${at(0.75)} ${at(0.85)}`, "ours theirs");
      press(pane, " ");
      equal(`${name}: a flip exchanges the sides`, `${at(0.75)} ${at(0.85)} ${names.value}`, "theirs ours theirs | ours");
      still("with theirs in front and a split");
      slide(slider, 0);
      equal(`${name}: split at 0 %`, `${at(0.05)} ${at(0.95)} ${names.value}`, "ours ours ours");
      pane.click();
      slide(slider, 100);
      equal(`${name}: as before`, `${at(0.05)} ${at(0.95)} ${names.value}`, "ours ours ours");
    }

    const [zoom, zoomed, reset] = [".zoom", ".zoomed", ".reset"].map((s) => scene.querySelector(s));
    const pane = scene.querySelector(".pane");
    equal(`${name}: whole at first`, aligned("at first").join(" "), "0 0 1");
    slide(zoom, 2);
    equal(`${name}: four times as large, about the middle`, aligned("after the slider").join(" "), "-1.5 -1.5 4");
    equal(`${name}: the zoom is said`, zoomed.value, "4\u00d7");
    still("when larger");
    press(pane, "ArrowRight");
    press(pane, "ArrowUp");
    equal(`${name}: arrow keys move`, aligned("after arrow keys").join(" "), "-1.6 -1.4 4");
    const box = pane.getBoundingClientRect();
    const [x, y] = [box.left + box.width / 2, box.top + box.height / 2];
    const turned = pane.classList.contains("turned");
    pointer(pane, "pointerdown", x, y);
    pointer(window, "pointermove", x + box.width / 4, y + box.height / 4);
    pointer(window, "pointerup", x + box.width / 4, y + box.height / 4);
    pane.click();
    equal(`${name}: dragging moves`, aligned("after dragging").join(" "), "-1.35 -1.15 4");
    equal(`${name}: dragging does not flip`, pane.classList.contains("turned"), turned);
    for (let i = 0; i < 40; i++) press(pane, "ArrowLeft");
    equal(`${name}: no further than the edge`, aligned("at the edge")[0], 0);
    press(pane, "-");
    equal(`${name}: minus halves`, aligned("after minus")[2], 2);
    press(pane, "+");
    equal(`${name}: plus doubles`, aligned("after plus")[2], 4);
    const wheel = { deltaY: -200, clientX: x, clientY: y, bubbles: true, cancelable: true };
    pane.dispatchEvent(new WheelEvent("wheel", wheel));
    equal(`${name}: the wheel alone scrolls the page`, aligned("after the wheel")[2], 4);
    pane.dispatchEvent(new WheelEvent("wheel", { ...wheel, ctrlKey: true }));
    equal(`${name}: the wheel with Ctrl doubles`, aligned("after the wheel with Ctrl")[2], 8);
    reset.click();
    equal(`${name}: reset`, `${aligned("after reset").join(" ")} ${zoom.value} ${zoomed.value}`, "0 0 1 0 1\u00d7");
    still("in the end");
  }

  for (const control of document.querySelectorAll("input, button, .pane")) {
    const label = control.getAttribute("aria-label") || control.textContent;
    check(`${control.className}: has a label and can be reached by keyboard`, label && control.tabIndex === 0, label);
  }
  for (const link of document.querySelectorAll("nav a, td a")) {
    const target = decodeURIComponent(link.hash.slice(1));
    check(`link to ${target}`, document.getElementById(target) !== null, "nothing");
  }
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  check("the page is no wider than the window", wide <= 0, `${wide} pixels`);

  const report = document.createElement("pre");
  report.id = "findings";
  const failed = findings.filter((line) => !line.startsWith("ok")).length;
  report.textContent = `${findings.join("\n")}\n${findings.length} checks, ${failed} failed`;
  document.body.append(report);
}

// At once after loading, before a browser without a window prints the page.
if (location.hash === "#selftest") window.addEventListener("load", selfTest);

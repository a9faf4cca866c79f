"use strict";
// Switches the map layers on screen and reads values off under the pointer. Without it, all maps are shown in turn.
(function () {
  const data = JSON.parse(document.getElementById("map-data").textContent);
  const maps = document.querySelector(".maps");
  const figures = [...maps.querySelectorAll("figure")];
  const tabs = document.querySelector(".tabs");
  const buttons = [];
  const readOut = document.querySelector(".read-out");

  function show(id) {
    for (const figure of figures) figure.classList.toggle("shown", figure.dataset.layer === id);
    for (const button of buttons) {
      const selected = button.dataset.layer === id;
      button.setAttribute("aria-selected", String(selected));
      button.tabIndex = selected ? 0 : -1;
    }
  }
  for (const figure of figures) {
    const button = document.createElement("button");
    button.type = "button";
    button.setAttribute("role", "tab");
    button.dataset.layer = figure.dataset.layer;
    button.addEventListener("click", () => show(figure.dataset.layer));
    buttons.push(button);
    const { name, group } = figure.dataset;
    button.textContent = group ? name.slice(group.length + 2) : name; // "Peak depth, particles"
    place(button, name, group);
  }
  // Tabs of maps that belong together stand behind the name that they share.
  function place(button, name, group) {
    let together = tabs;
    if (group) {
      button.setAttribute("aria-label", name);
      tabs.classList.add("grouped");
      together = tabs.lastElementChild;
      if (together?.dataset.group !== group) {
        together = document.createElement("div");
        together.className = "tab-group";
        together.dataset.group = group;
        const label = document.createElement("span");
        label.textContent = group;
        together.append(label);
        tabs.append(together);
      }
    }
    together.append(button);
  }
  tabs.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const at = buttons.findIndex((b) => b.getAttribute("aria-selected") === "true");
    const next = buttons[(at + step + buttons.length) % buttons.length];
    show(next.dataset.layer);
    next.focus();
  });
  maps.classList.add("interactive");
  document.querySelector(".controls").hidden = false;
  readOut.hidden = false;
  show(figures[0].dataset.layer);
  document.getElementById("opacity").addEventListener("input", (event) => {
    document.documentElement.style.setProperty("--layer-opacity", event.target.value / 100);
  });

  // A grid's values travel as a picture: red and green are the high and low byte of a count of steps, 0 is "none".
  function load(grid) {
    const picture = new Image();
    picture.addEventListener("load", () => {
      const canvas = document.createElement("canvas");
      canvas.width = grid.columns;
      canvas.height = grid.rows;
      const context = canvas.getContext("2d", { willReadFrequently: true });
      context.drawImage(picture, 0, 0);
      grid.pixels = context.getImageData(0, 0, grid.columns, grid.rows).data;
    });
    picture.src = grid.values;
  }
  function valueAt(grid, east, north) {
    if (!grid || !grid.pixels) return null;
    const column = Math.floor((east - grid.x_min) / grid.cell);
    const row = Math.floor((grid.y_max - north) / grid.cell);
    if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) return null;
    const at = 4 * (row * grid.columns + column);
    const steps = grid.pixels[at] * 256 + grid.pixels[at + 1];
    return steps === 0 ? null : grid.base + (steps - 1) * grid.resolution;
  }
  load(data.ground);
  data.layers.forEach(load);

  maps.addEventListener("pointermove", (event) => {
    const svg = event.target.closest("svg.figure");
    if (!svg) return;
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const x = p.x - data.left, y = p.y - data.top;
    if (x < 0 || y < 0 || x > data.width || y > data.height) return;
    const east = data.x_min + x / data.scale, north = data.y_max - y / data.scale;
    const layer = data.layers.find((l) => l.id === svg.closest("figure").dataset.layer);
    const ground = valueAt(data.ground, east, north), value = valueAt(layer, east, north);
    const parts = [`E <b>${east.toFixed(1)}</b> m`, `N <b>${north.toFixed(1)}</b> m`];
    parts.push(`ground <b>${ground === null ? "no data" : ground.toFixed(1) + " m"}</b>`);
    if (layer) {
      const text = value === null ? "none" : layer.classes ? layer.classes[Math.round(value) - 1] : `${value.toFixed(layer.digits)} ${layer.unit}`;
      parts.push(`${layer.name.toLowerCase()} <b>${text}</b>`);
    }
    readOut.innerHTML = parts.join(" &nbsp;·&nbsp; ");
  });
})();

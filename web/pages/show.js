// A page with a show on it: <body data-show="name" data-files="what it needs of assets/" data-program="which program has it, if not shows">.

import { lacking, load } from "./load.js";
import { Weights } from "./weights.js";

const main = document.querySelector("main");
/** Keys that all shows have: what they are called in the program (several are held together) and on the page, and what they do. */
const KEYS = [
  // Where the show needs Space for something else, another key pauses.
  document.body.dataset.pause === "P" ? ["KeyP", "P", "Pause"] : ["Space", "Space", "Pause"],
  ["Period", ".", "One frame"],
  ["Minus", "−", "Slower"],
  ["Equal", "=", "Faster"],
  ["KeyT", "T", "Touching triangles"],
  ["KeyV", "V", "Boxes, a level down"],
  ["ShiftLeft KeyV", "Shift V", "Boxes, a level up"],
];
/** And those of this show: data-keys="KeyX X Remove the pins; ...". */
const OWN_KEYS = (document.body.dataset.keys ?? "").split(";").filter(Boolean).map((line) => {
  const [code, key, ...words] = line.trim().split(" ");
  return [code, key, words.join(" ")];
});
const keyButton = ([code, key, words]) => `<button type="button" data-code="${code}">${words} <kbd>${key}</kbd></button>`;
main.insertAdjacentHTML("afterbegin", `
  <div class="stage">
    <canvas id="show" tabindex="0" aria-label="The show. Drag to look around; the buttons below it stand for its keys."></canvas>
    <div class="cover"><p class="what" role="status">Loading</p><progress></progress></div>
  </div>
  <div class="keys" role="group" aria-label="Keys of the show">${[...OWN_KEYS, ...KEYS].map(keyButton).join("")}</div>
  <p class="hands"><b>Mouse:</b> the right button looks around, the middle one moves the view, the wheel zooms. <b>Touch:</b> one finger looks around, two zoom. The
    keys work while the picture has the focus: click on it, or press Tab.</p>
  <dl class="counts" aria-label="What the show counts"></dl>`);
const [cover, what, bar, counts] = [".cover", ".what", "progress", ".counts"].map((name) => main.querySelector(name));
const canvas = main.querySelector("canvas");
// The program gives its canvas the focus, and the browser would scroll the page's headline away to show all of it.
canvas.focus = () => HTMLElement.prototype.focus.call(canvas, { preventScroll: true });

// A button holds its key as long as it is pressed itself, so that all keys can be used without a keyboard.
for (const button of main.querySelectorAll(".keys button")) {
  const codes = button.dataset.code.split(" ");
  const send = (type) => {
    for (const code of type === "keydown" ? codes : codes.toReversed()) {
      const key = code === "ShiftLeft" ? "Shift" : code.replace(/^Key/, "").toLowerCase();
      canvas.dispatchEvent(new KeyboardEvent(type, { code, key, bubbles: true }));
    }
  };
  button.addEventListener("pointerdown", () => send("keydown"));
  // The focus stays on the canvas: a program that loses it releases all its keys.
  button.addEventListener("mousedown", (event) => event.preventDefault());
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) button.addEventListener(end, () => send("keyup"));
  // Enter and Space on the button: there is no pointer.
  button.addEventListener("click", ({ detail }) => {
    if (detail !== 0) return;
    send("keydown");
    setTimeout(() => send("keyup"), 100);
  });
}

const weights = new Weights(main, { state: () => show.state(), give: (weights) => show.stage?.weigh(weights) });

/** What a test, or a curious user, may ask. */
export const show = {
  stage: null,
  /** Why there is nothing to be seen, or null. */
  trouble: null,
  state: () => (show.stage ? JSON.parse(show.stage.state()) : null),
};
window.show = show;

function stop(trouble) {
  show.trouble ??= String(trouble);
  what.textContent = show.trouble;
  what.className = "what trouble";
  what.setAttribute("role", "alert");
  bar.hidden = true;
  cover.hidden = false;
}

addEventListener("error", (event) => stop(`The program has stopped: ${event.message}. Reload the page to start again.`));
addEventListener("unhandledrejection", (event) => stop(`The program has stopped: ${event.reason?.message ?? event.reason}. Reload the page to start again.`));
canvas.addEventListener("webglcontextlost", () => stop("The browser lost access to the graphics card. Reload the page to start again."));

/** Starts the show; what it counts is told as long as it runs. */
async function start() {
  const lack = lacking({ drawing: true });
  if (lack) return stop(lack);
  const { show: name, files = "", program = "shows" } = document.body.dataset;
  const names = files.split(" ").filter(Boolean);
  try {
    const { default: init, Stage } = await import(`./${program}.js`);
    const bytes = await load({ program: `${program}_bg.wasm`, init }, names.map((file) => `assets/${file}`), what, bar);
    const stage = new Stage();
    names.forEach((file, i) => stage.provide(file, bytes[i]));
    stage.start(name, "#show");
    show.stage = stage;
  } catch (error) {
    return stop(error.message ?? error);
  }
  bar.removeAttribute("value");
  let before = { drawn: 0, time: performance.now() };
  const timer = setInterval(() => {
    if (show.trouble) return clearInterval(timer);
    const state = show.state();
    if (state.trouble) return stop(state.trouble);
    if (state.started && !cover.hidden) {
      cover.hidden = true;
      canvas.focus();
    }
    const time = performance.now();
    tell(state, (1000 * (state.drawn - before.drawn)) / (time - before.time));
    before = { drawn: state.drawn, time };
  }, 500);
}

function tell(state, rate) {
  weights.show(state);
  main.querySelector("[data-code=KeyT]").setAttribute("aria-pressed", String(state.touching_drawn));
  const pace = !state.started ? "" : state.paused ? "paused" : state.speed === 1 ? "" : `speed ${state.speed}`;
  const lines = [
    ["frame", [Math.round(state.frame), pace].filter(String).join(", ")],
    ["frames per second", rate.toFixed(rate < 10 ? 1 : 0)],
    ...(state.volumes === null ? [] : [["boxes drawn", `level ${state.volumes}`]]),
    ...state.notes,
    ...state.counts,
  ];
  counts.replaceChildren(...lines.map(([name, value]) => {
    const row = document.createElement("div");
    const [term, number] = [document.createElement("dt"), document.createElement("dd")];
    term.textContent = name;
    number.textContent = value;
    row.append(term, number);
    return row;
  }));
}

/** When the show is on its stage, or cannot be. */
export const started = start();

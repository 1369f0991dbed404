// Lint of one's own model, or of a sample.

import { receive } from "./files.js";
import { Panel } from "./lint_panel.js";

const element = document.querySelector("section.lint");
const panel = new Panel(element);
/** What a test may ask. */
window.lint = panel;

const { giveSample, listenTo } = receive({
  target: element,
  bring: async (name, read) => panel.bring(name, await read()),
  refuse: (why) => panel.refuse(why),
});
panel.report.addEventListener("load", () => listenTo(panel.report.contentWindow));
// Something is to be seen from the start.
giveSample("mh_head_eyes_teeth_arkit52.glb");

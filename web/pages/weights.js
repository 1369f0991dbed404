// The weights of a show's models, and sliders to set them by hand.

export class Weights {
  /** Adds the closed list of sliders to `parent`. `give(weights)` gives all models these weights, or their own if there are none. */
  constructor(parent, give) {
    parent.insertAdjacentHTML("beforeend", `
      <details class="weights" hidden>
        <summary>Weights</summary>
        <label><input type="checkbox"> Set them by hand, for all models</label>
        <div class="sliders"></div>
      </details>`);
    this.list = parent.querySelector(".weights");
    [this.hand, this.rows] = ["input", ".sliders"].map((name) => this.list.querySelector(name));
    this.give = give;
    this.hand.addEventListener("change", () => this.changed());
    this.rows.addEventListener("input", ({ target }) => {
      target.nextElementSibling.value = Number(target.value).toFixed(2);
      this.changed();
    });
  }

  get sliders() { return [...this.rows.querySelectorAll("input")]; }

  changed() {
    for (const slider of this.sliders) slider.disabled = !this.hand.checked;
    this.give(this.hand.checked ? new Float32Array(this.sliders.map((slider) => Number(slider.value))) : undefined);
  }

  /** Gives the models their own weights again. */
  release() {
    this.hand.checked = false;
    this.changed();
  }

  /** Shows what the models play, unless the sliders are set by hand. */
  show({ targets, weights }) {
    this.list.hidden = targets.length === 0;
    if (this.names !== targets.join("\n")) {
      this.names = targets.join("\n");
      this.rows.replaceChildren(...targets.map(row));
      this.changed();
    }
    if (this.hand.checked || !this.list.open) return;
    this.sliders.forEach((slider, i) => {
      slider.value = weights[i];
      slider.nextElementSibling.value = weights[i].toFixed(2);
    });
  }
}

function row(target) {
  const [label, name, slider, value] = ["label", "span", "input", "output"].map((tag) => document.createElement(tag));
  name.textContent = target;
  Object.assign(slider, { type: "range", min: -0.5, max: 1.5, step: 0.01, value: 0, ariaLabel: target });
  label.append(name, slider, value);
  return label;
}

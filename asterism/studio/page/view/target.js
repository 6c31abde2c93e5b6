// The target surface as a ghost beside the sheet: fetched when the server has another one or another pose.

import { unpack } from "../connection.js";
import { toast } from "../panels/toasts.js";
import { vertexNormals } from "./sheet.js";

const GHOST = { base: [0.66, 0.42, 0.82], alpha: 0.34, shine: 0.1 };

export class Target {
  look = GHOST;
  #version = null;

  /** `onChange` is called when the ghost has changed. */
  constructor(renderer, store, onChange) {
    Object.assign(this, { renderer, onChange, surface: renderer.makeSurface() });
    store.on(["state"], ({ state }) => this.#follow(state.target));
    store.on(["showTarget"], onChange);
  }

  async #follow(target) {
    const version = target?.version ?? null;
    if (version === this.#version) return;
    this.#version = version;
    if (version === null) {
      this.surface.count = 0;
      return this.onChange();
    }
    try {
      const answer = await fetch(`target?version=${version}`);
      if (!answer.ok) throw new Error(String(answer.status));
      const { positions, triangles } = unpack(await answer.arrayBuffer()).arrays;
      if (version !== this.#version) return;
      this.renderer.fill(this.surface, { positions, normals: vertexNormals(positions, triangles), triangles });
      this.onChange();
    } catch {
      this.#version = null; // the next message of the server tries again
      toast("The target surface could not be fetched.", { isBad: true });
    }
  }
}

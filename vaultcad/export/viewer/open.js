// Opens the 3D view: unpacks three.js, the view and its scene, which until then cost nothing but the bytes of the page.
(() => {
  "use strict";
  const section = document.getElementById("view3d");
  const failed = section.querySelector(".view-failed");

  async function unpacked(name) {
    const letters = section.querySelector(`[data-packed="${name}"]`).textContent;
    const packed = Uint8Array.from(atob(letters), (letter) => letter.charCodeAt(0));
    const plain = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Response(plain).arrayBuffer();
  }

  async function open(event) {
    const button = event.currentTarget;
    button.disabled = true;
    try {
      if (!window.DecompressionStream) throw new Error("the browser is too old: it has no DecompressionStream");
      const [library, code, scene] = await Promise.all(["library", "code", "scene"].map(unpacked));
      const text = new TextDecoder();
      new Function(text.decode(library))();
      const stage = section.querySelector(".view-stage");
      button.parentElement.hidden = true;
      stage.hidden = false;
      new Function("stage", "scene", text.decode(code))(stage, scene);
      stage.querySelector("canvas").focus({ preventScroll: true });
    } catch (error) {
      section.querySelector(".view-stage").hidden = true;
      failed.textContent = `The 3D view cannot be shown: ${error.message}.`;
      failed.hidden = false;
    }
  }

  section.querySelector(".view-open").addEventListener("click", open);
})();

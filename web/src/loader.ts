// The first script of a published twin in one file: it inflates the page's own style and script, a quarter of their bytes, and
// puts them in. The policy of the file names all three.
import { inflatedBlock } from "./protocol/block";

async function textOf(id: string): Promise<string> {
  const text = await (await inflatedBlock(id))?.text();
  if (!text) throw new Error(`the file holds no ${id}`);
  return text;
}

async function load(): Promise<void> {
  try {
    const [style, script] = [document.createElement("style"), document.createElement("script")];
    [style.textContent, script.textContent] = await Promise.all([textOf("style"), textOf("script")]);
    script.type = "module";
    document.head.append(style);
    document.body.append(script);
  } catch (error) {
    console.error(error);
    const said = document.querySelector(".boot");
    if (said === null) return;
    said.setAttribute("role", "alert");
    said.textContent = "DecompressionStream" in window
      ? "This twin could not be opened: the file is cut off or damaged. Get it again."
      : "This twin could not be opened: it needs a browser of 2023 or later.";
  }
}

void load();

// The first script of a published twin in one file: it inflates the page's own script, a quarter of its bytes, and runs it. The
// policy of the file names both.
import { inflatedBlock } from "./protocol/block";

async function load(): Promise<void> {
  try {
    const script = document.createElement("script");
    script.type = "module";
    script.textContent = (await (await inflatedBlock("script"))?.text()) ?? "";
    if (script.textContent === "") throw new Error("the file holds no script");
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

// Over the view, once the camera no longer follows the front: back to it.
import type { Follow } from "../scene/follow";
import type { Stage } from "../scene/stage";
import { watchAll } from "../state/cell";
import type { Twin } from "../state/twin";
import { button } from "../ui/dom";

export function followButton(twin: Twin, stage: Stage, follow: Follow): HTMLElement {
  const element = button("Follow the front", { icon: "follow", class: "follow-again", title: "The camera goes with the front again (3)", onclick: () => stage.rig.setMode("follow") });
  const show = (): void => {
    const over = ["ended", "at_rest"].includes(twin.now.state.value?.status ?? "") && twin.replay_s.value === null;
    element.hidden = stage.rig.mode === "follow" || over || twin.tool.value.kind !== "none" || follow.front() === null;
  };
  stage.rig.watchMode(show);
  watchAll([twin.edited, twin.replay_s, twin.tool, ...twin.every("state")], show);
  return element;
}

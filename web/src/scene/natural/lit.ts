// Houses, barriers and trees in the light and air of the natural look; as they are in the scientific one.
import type { IUniform, MeshLambertMaterial } from "three";
import { airHead, forLook } from "./daylight";

export interface ShaderParts {
  vertexHead?: string;
  /** After the place of a vertex is known: `transformed`. */
  place?: string;
  head?: string;
  /** Changes `diffuseColor`. */
  colour?: string;
  /** Changes `outgoingLight`, before air and exposure. */
  light?: string;
}

export function lit(material: MeshLambertMaterial, uniforms: Record<string, IUniform>, parts: ShaderParts = {}): MeshLambertMaterial {
  const { vertexHead = "", place = "", head = "", colour = "", light = "" } = parts;
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, uniforms);
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${vertexHead}`)
      .replace("#include <begin_vertex>", `#include <begin_vertex>\n${place}`);
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>\n${airHead}\n${head}`)
      .replace("#include <color_fragment>", `#include <color_fragment>\n${colour}`)
      .replace("#include <opaque_fragment>", `
        #ifdef NATURAL
          vec3 sight = (vec4(-vViewPosition, 0.0) * viewMatrix).xyz;
          ${light}
          outgoingLight = developed(throughAir(outgoingLight, sight));
        #endif
        #include <opaque_fragment>`);
  };
  // Without it three.js would take all of these for one program.
  material.customProgramCacheKey = () => vertexHead + place + head + colour + light;
  return forLook(material, uniforms["uNatural"]);
}

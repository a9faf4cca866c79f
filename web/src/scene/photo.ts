// The orthophoto that a scene may have, as a texture for the ground.
import { LinearFilter, LinearMipmapLinearFilter, SRGBColorSpace, Texture, Vector4 } from "three";
import type { SceneInfo } from "../protocol/messages";
import type { Photo } from "./ground";

/** The server has cut the picture to the terrain. */
export async function photoTexture(picture: Blob, scene: SceneInfo): Promise<Photo> {
  // Pictures begin in the north, textures in the south.
  const bitmap = await createImageBitmap(picture, { imageOrientation: "flipY", premultiplyAlpha: "none" });
  const texture = new Texture(bitmap);
  texture.flipY = false;
  texture.colorSpace = SRGBColorSpace;
  texture.magFilter = LinearFilter;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = 8;
  texture.needsUpdate = true;
  const [west, south, east, north] = scene.extent_m;
  return { texture, gain: gainOf(bitmap), placing: new Vector4(west - scene.origin[0], south - scene.origin[1], 1 / (east - west), 1 / (north - south)) };
}

/** Share of light that ground reflects in the mean. */
const ground = 0.14;

/** A photograph may be dark or bright: of its own light nothing is known. */
function gainOf(bitmap: ImageBitmap): number {
  const side = 16;
  const context = new OffscreenCanvas(side, side).getContext("2d");
  if (!context) return 1;
  context.drawImage(bitmap, 0, 0, side, side);
  const { data } = context.getImageData(0, 0, side, side);
  let sum = 0;
  for (let k = 0; k < data.length; k += 4) sum += 0.25 * (data[k] / 255) ** 2.2 + 0.65 * (data[k + 1] / 255) ** 2.2 + 0.1 * (data[k + 2] / 255) ** 2.2;
  return Math.min(2.5, Math.max(0.2, ground / Math.max(1e-3, sum / (side * side))));
}

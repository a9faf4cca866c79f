// The orthophoto that a scene may have, as a texture for the ground.
import { LinearFilter, LinearMipmapLinearFilter, SRGBColorSpace, Texture, Vector4 } from "three";
import type { SceneInfo } from "../protocol/messages";
import type { Draped } from "./ground";

/** The server has cut the picture to the terrain. */
export async function photoTexture(picture: Blob, scene: SceneInfo): Promise<Draped> {
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
  return { texture, placing: new Vector4(west - scene.origin[0], south - scene.origin[1], 1 / (east - west), 1 / (north - south)) };
}

// Light, air and exposure of the natural look, for all views of the page.
import { Vector3, type Color, type IUniform, type Material } from "three";
import type { Relief } from "../relief";
import { lightAt, sunAt, usualMoment, type Light, type Moment } from "./sun";
import { noiseTexture } from "./noise";

/** Shared by all shaders of the natural look. What they compute is the brightness of a scene, of any range. */
export const airHead = /* glsl */ `
  uniform float uExposure, uAirDensity, uDetail;
  uniform vec3 uSunWorld, uSunLight, uSkyLight, uHorizon, uZenith, uGlow;
  uniform sampler2D uNoise;
  vec3 skyTowards(vec3 d) {
    float up = max(d.z, 0.0);
    vec3 colour = mix(uHorizon, uZenith, 1.0 - exp(-3.2 * up));
    float near = max(dot(d, uSunWorld), 0.0);
    return colour + uGlow * (0.23 * pow(near, 6.0) + 0.77 * pow(near, 60.0));
  }
  // What is left of a colour at the end of a line of sight, and the light of the air before it.
  vec3 throughAir(vec3 colour, vec3 sight) {
    float far = length(sight);
    vec3 d = sight / max(far, 0.001);
    return mix(skyTowards(vec3(d.xy, max(d.z, 0.02))), colour, exp(-far * uAirDensity));
  }
  // To the range of a screen: no brightness becomes more than white. Curve after Narkowicz (2016), ACES filmic tone mapping curve.
  vec3 developed(vec3 colour) {
    vec3 c = colour * uExposure;
    return clamp((c * (2.51 * c + 0.03)) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0);
  }
`;

/**
 * Compiles the shader of a material for the look that is shown, with NATURAL for the natural one. A branch for the other would be computed and
 * thrown away where a processor takes the place of a graphics card. Both stay compiled once they were shown.
 */
export function forLook<M extends Material & { defines?: Record<string, unknown> }>(material: M, natural: IUniform<number>): M {
  material.onBeforeRender = () => {
    const shown = natural.value > 0;
    if ((material.defines?.["NATURAL"] !== undefined) === shown) return;
    material.defines = { ...material.defines };
    if (shown) material.defines["NATURAL"] = "";
    else delete material.defines["NATURAL"];
    material.needsUpdate = true;
  };
  return material;
}

/** Mean brightness of ground in a picture before the curve: middle grey behind it. */
const wanted = 0.21;
/** Share of light that ground of this look reflects, in the mean. */
const albedo = 0.13;

const bright = ({ r, g, b }: Color): number => 0.25 * r + 0.65 * g + 0.1 * b;

export class Daylight {
  readonly towards = new Vector3();
  light: Light = lightAt(1);
  moment: Moment = usualMoment;
  readonly uniforms = {
    uNatural: { value: 0 }, uExposure: { value: 1 }, uAirDensity: { value: 0 }, uDetail: { value: 2 },
    uSunWorld: { value: this.towards }, uSunLight: { value: new Vector3() }, uSkyLight: { value: new Vector3() },
    uGlow: { value: new Vector3() }, uHorizon: { value: new Vector3() }, uZenith: { value: new Vector3() }, uNoise: { value: noiseTexture() },
  } satisfies Record<string, IUniform>;

  constructor(private readonly relief: Relief, private readonly latitude_deg: number) {
    this.set(usualMoment);
  }
  set(moment: Moment): void {
    this.moment = moment;
    sunAt(moment, this.latitude_deg, this.towards);
    this.light = lightAt(this.towards.z);
    const { uSunLight, uSkyLight, uHorizon, uZenith, uExposure } = this.uniforms;
    for (const [uniform, { r, g, b }] of [[uSunLight, this.light.sun], [uSkyLight, this.light.sky], [uHorizon, this.light.horizon], [uZenith, this.light.zenith]] as const) {
      uniform.value.set(r, g, b);
    }
    // A night is shown darker and bluer than a day, but shown.
    const night = Math.min(1, Math.max(0, -8 * this.towards.z));
    uExposure.value = (wanted * (1 - 0.6 * night)) / ((albedo / Math.PI) * this.groundLight());
    // At dusk the sky is far brighter than the ground: it, and the air before the ground, must not outshine it in the picture.
    const dim = (of: Color, brightest: number): number => Math.min(1, brightest / Math.max(1e-9, bright(of) * uExposure.value));
    const sky = dim(this.light.horizon, 0.62 - 0.5 * night);
    uHorizon.value.multiplyScalar(sky);
    uZenith.value.multiplyScalar(sky);
    const { r, g, b } = this.light.sun;
    this.uniforms.uGlow.value.set(r, g, b).multiplyScalar(0.15 * dim(this.light.sun, 2.2));
  }
  /** In a plan all ground is equally far: its air would only be a veil. */
  prepare(natural: boolean, plan: boolean, detail: number): void {
    const { relief, uniforms } = this;
    uniforms.uNatural.value = natural ? 1 : 0;
    uniforms.uAirDensity.value = plan ? 0 : 0.06 / Math.hypot(relief.width, relief.height);
    uniforms.uDetail.value = detail;
  }
  /** Mean light on the ground: what the exposure goes by, so that it is neither black nor white at any hour. */
  private groundLight(): number {
    const { grid } = this.relief;
    const parts = 24;
    let sun = 0;
    for (let j = 0; j < parts; ++j) {
      for (let i = 0; i < parts; ++i) {
        const x = grid.west + ((i + 0.5) / parts) * this.relief.width;
        const y = grid.south + ((j + 0.5) / parts) * this.relief.height;
        const e = 2 * grid.cell;
        const u = (this.relief.at(x - e, y) - this.relief.at(x + e, y)) / (2 * e);
        const v = (this.relief.at(x, y - e) - this.relief.at(x, y + e)) / (2 * e);
        sun += Math.max(0, (u * this.towards.x + v * this.towards.y + this.towards.z) / Math.hypot(u, v, 1));
      }
    }
    return (sun / (parts * parts)) * bright(this.light.sun) + 0.75 * bright(this.light.sky);
  }
}

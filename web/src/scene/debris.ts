// Debris as round shaded points. The two frames are in two vertex buffers as received; the vertex shader interpolates
// between them, so that there is no work per particle between frames.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage, NormalBlending, Points, ShaderMaterial, Vector3, type Texture } from "three";
import { absent, type Frame } from "../protocol/frame";

/** Of all shaders that draw particles: their buffers, and with `particlePlace` the place and speed between the two frames. */
export const particleHead = /* glsl */ `
  attribute vec4 particle0;
  attribute vec4 particle1;
  uniform vec3 uOrigin0, uOrigin1, uScale0, uScale1;
  uniform float uSpeedUnit0, uSpeedUnit1, uMix, uFastest, uDiameter, uPixels;
`;
export const particlePlace = /* glsl */ `
    bool there0 = particle0.x < 65534.5 || particle0.y < 65534.5 || particle0.z < 65534.5;
    bool there1 = particle1.x < 65534.5 || particle1.y < 65534.5 || particle1.z < 65534.5;
    vec3 at0 = uOrigin0 + uScale0 * particle0.xyz;
    vec3 at1 = uOrigin1 + uScale1 * particle1.xyz;
    float share = there0 && there1 ? uMix : (there1 ? 1.0 : 0.0);
    bool shown = (there0 && there1) || (there1 && uMix > 0.5) || (there0 && uMix <= 0.5);
    vec3 place = mix(at0, at1, share);
    float speed = mix(particle0.w * uSpeedUnit0, particle1.w * uSpeedUnit1, share);
`;

const vertex = /* glsl */ `
  ${particleHead}
  varying float vShare, vRim;
  void main() {
    ${particlePlace}
    vShare = speed / uFastest;
    vec4 seen = modelViewMatrix * vec4(place, 1.0);
    gl_Position = shown ? projectionMatrix * seen : vec4(2.0, 2.0, 2.0, 1.0);
    // In a plan (the last row of its projection is 0 0 0 1) size does not depend on distance.
    gl_PointSize = shown ? max(2.5, uDiameter * uPixels / (projectionMatrix[3][3] > 0.5 ? 1.0 : -seen.z)) : 0.0;
    vRim = 0.4 * smoothstep(3.0, 12.0, gl_PointSize);
  }
`;

const fragment = /* glsl */ `
  uniform sampler2D uRamp;
  uniform vec3 uSun;
  varying float vShare, vRim;
  void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    float r2 = dot(at, at);
    if (r2 > 1.0) discard;
    vec3 normal = vec3(at.x, -at.y, sqrt(1.0 - r2));
    vec3 colour = texture2D(uRamp, vec2(clamp(vShare, 0.002, 0.998), 0.5)).rgb;
    float light = 0.55 + 0.62 * max(dot(normal, uSun), 0.0);
    // The rim separates grains from one another; for grains of a few pixels it would only darken them.
    light *= 1.0 - vRim * smoothstep(0.55, 1.0, r2);
    gl_FragColor = vec4(colour * light, 1.0);
    #include <colorspace_fragment>
  }
`;

export class Debris {
  readonly points: Points;
  readonly geometry = new BufferGeometry();
  private readonly attributes: [BufferAttribute, BufferAttribute];
  private newest = 0;
  readonly uniforms;

  constructor(diameter_m: number, ramp: Texture) {
    this.uniforms = {
      uOrigin0: { value: new Vector3() }, uOrigin1: { value: new Vector3() },
      uScale0: { value: new Vector3() }, uScale1: { value: new Vector3() },
      uSpeedUnit0: { value: 0 }, uSpeedUnit1: { value: 0 },
      uMix: { value: 1 }, uFastest: { value: 10 }, uDiameter: { value: diameter_m }, uPixels: { value: 500 },
      uRamp: { value: ramp }, uSun: { value: new Vector3(0, 0, 1) },
    };
    this.attributes = [this.allocate(0, 1024), this.allocate(1, 1024)];
    this.geometry.setAttribute("position", this.attributes[1]);
    this.geometry.setDrawRange(0, 0);
    const material = new ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, uniforms: this.uniforms, blending: NormalBlending });
    this.points = new Points(this.geometry, material);
    this.points.frustumCulled = false;
  }

  private allocate(which: 0 | 1, count: number): BufferAttribute {
    const attribute = new BufferAttribute(new Uint16Array(4 * count), 4);
    attribute.setUsage(DynamicDrawUsage);
    this.geometry.setAttribute(`particle${which}`, attribute);
    return attribute;
  }
  /** length: of the newest frame; what a frame lacks of that does not exist in it. */
  private fill(which: 0 | 1, frame: Frame, length: number): void {
    const attribute = this.attributes[which];
    const values = attribute.array as Uint16Array;
    values.set(frame.particles);
    if (frame.particles.length < length) values.fill(absent, frame.particles.length, length);
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(0, length);
    attribute.needsUpdate = true;
    const u = this.uniforms;
    (which === 0 ? u.uOrigin0 : u.uOrigin1).value.set(...frame.origin);
    (which === 0 ? u.uScale0 : u.uScale1).value.set(...frame.scale);
    (which === 0 ? u.uSpeedUnit0 : u.uSpeedUnit1).value = frame.speedUnit_mps;
  }

  push(frame: Frame, previous: Frame, joins: boolean): void {
    // New particles have no earlier position; after a gap the older of the two is the same.
    const older = joins && previous.count <= frame.count ? previous : frame;
    if (frame.count > this.attributes[0].count) {
      const room = Math.ceil(1.5 * frame.count);
      this.geometry.dispose();
      this.attributes[0] = this.allocate(0, room);
      this.attributes[1] = this.allocate(1, room);
      this.geometry.setAttribute("position", this.attributes[1]);
    } else if (joins && older.count === frame.count) {
      this.newest = 1 - this.newest;
      this.fill(this.newest as 0 | 1, frame, frame.particles.length);
      return;
    }
    this.fill((1 - this.newest) as 0 | 1, older, frame.particles.length);
    this.fill(this.newest as 0 | 1, frame, frame.particles.length);
    this.geometry.setDrawRange(0, frame.count);
  }
  mix(fraction: number): void {
    this.uniforms.uMix.value = this.newest === 1 ? fraction : 1 - fraction;
  }
  /** pixels: of a metre, in a perspective at a distance of 1 m. */
  prepare(pixels: number, sunInView: Vector3, fastest_mps: number): void {
    this.uniforms.uPixels.value = pixels;
    this.uniforms.uSun.value.copy(sunInView);
    this.uniforms.uFastest.value = fastest_mps;
  }
  dispose(): void {
    this.geometry.dispose();
    (this.points.material as ShaderMaterial).dispose();
  }
}

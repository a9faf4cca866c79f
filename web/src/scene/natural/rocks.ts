// Coarse debris on the mud, and spray where it is fast: some of the particles, drawn from the buffers that hold all of them.
import { NormalBlending, Points, ShaderMaterial, type BufferGeometry, type IUniform } from "three";
import { rocksFragment, rocksVertex, sprayFragment, sprayVertex } from "./rocks_shader";

export class Rocks {
  readonly rocks: Points;
  readonly spray: Points;

  /** geometry, particles: of the debris; flow: its depth and speed on the ground. */
  constructor(geometry: BufferGeometry, particles: Record<string, IUniform>, flow: Record<string, IUniform>) {
    const uniforms = { ...flow, ...particles };
    this.rocks = new Points(geometry, new ShaderMaterial({ vertexShader: rocksVertex, fragmentShader: rocksFragment, uniforms }));
    this.spray = new Points(geometry, new ShaderMaterial({ vertexShader: sprayVertex, fragmentShader: sprayFragment, uniforms, transparent: true,
      depthWrite: false, blending: NormalBlending }));
    this.rocks.frustumCulled = this.spray.frustumCulled = false;
    this.spray.renderOrder = 5;
    this.show(false, false);
  }
  show(rocks: boolean, spray: boolean): void {
    this.rocks.visible = rocks;
    this.spray.visible = spray;
  }
  dispose(): void {
    (this.rocks.material as ShaderMaterial).dispose();
    (this.spray.material as ShaderMaterial).dispose();
  }
}

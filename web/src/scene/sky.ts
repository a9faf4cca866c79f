// Sky, sun and their light.
import { BackSide, DirectionalLight, HemisphereLight, Mesh, ShaderMaterial, SphereGeometry, Vector3, type Box3, type Scene } from "three";

/** Towards the sun: from the north-west, as maps are lit, so that relief is not perceived inverted. */
export const towardsSun = new Vector3(-0.62, 0.5, 0.72).normalize();

const vertex = /* glsl */ `
  varying vec3 vDirection;
  void main() {
    vDirection = position;
    vec4 at = projectionMatrix * vec4(mat3(viewMatrix) * position, 1.0);
    // Around a plan there is no sky.
    gl_Position = projectionMatrix[3][3] > 0.5 ? vec4(2.0, 2.0, 2.0, 1.0) : at.xyww;
  }
`;
const fragment = /* glsl */ `
  varying vec3 vDirection;
  uniform vec3 uSun;
  void main() {
    vec3 d = normalize(vDirection);
    vec3 horizon = vec3(0.925, 0.938, 0.945), zenith = vec3(0.545, 0.682, 0.788), below = vec3(0.815, 0.835, 0.842);
    vec3 colour = d.z > 0.0 ? mix(horizon, zenith, pow(d.z, 0.6)) : mix(horizon, below, pow(-d.z, 0.5));
    colour += vec3(0.10, 0.08, 0.04) * pow(max(dot(d, uSun), 0.0), 6.0);
    gl_FragColor = vec4(colour, 1.0);
  }
`;

export class Sky {
  readonly sun = new DirectionalLight(0xfff2df, 3.5);
  private readonly dome: Mesh;

  constructor(scene: Scene) {
    this.dome = new Mesh(
      new SphereGeometry(1, 32, 24),
      new ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, side: BackSide, depthWrite: false, uniforms: { uSun: { value: towardsSun } } }),
    );
    this.dome.frustumCulled = false;
    this.dome.renderOrder = -10;
    const fill = new HemisphereLight(0xdfeaf5, 0xb3a48e, 1.75);
    fill.position.set(0, 0, 1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.15;
    scene.add(this.dome, fill, this.sun, this.sun.target);
  }
  /** Makes shadows as sharp as the extent of the solids allows. */
  aim(solids: Box3): void {
    if (solids.isEmpty()) {
      this.sun.castShadow = false;
      return;
    }
    this.sun.castShadow = true;
    const middle = solids.getCenter(new Vector3());
    const reach = solids.getSize(new Vector3()).length() / 2 + 25;
    this.sun.target.position.copy(middle);
    this.sun.position.copy(middle).addScaledVector(towardsSun, 2 * reach);
    const camera = this.sun.shadow.camera;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0.1;
    camera.far = 4 * reach;
    camera.updateProjectionMatrix();
  }
}

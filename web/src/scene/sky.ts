// Sky, sun and their light.
import { BackSide, DirectionalLight, HemisphereLight, Mesh, ShaderMaterial, SphereGeometry, Vector3, type Box3, type Scene } from "three";
import { airHead, forLook, type Daylight } from "./natural/daylight";

/** Towards the sun of the scientific look: from the north-west, as maps are lit, so that relief is not perceived inverted. */
const mapSun = new Vector3(-0.62, 0.5, 0.72).normalize();

/** Largest extent of the map of shadows: its cells are then a third of a metre wide. */
const widestShadows_m = 600;

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
  ${airHead}
  varying vec3 vDirection;
  uniform vec3 uMapSun;
  void main() {
    vec3 d = normalize(vDirection);
    #ifdef NATURAL
    vec3 sky = skyTowards(vec3(d.xy, max(d.z, 0.0)));
    // Clouds, thin towards the horizon; none below it, where the ground ends in haze.
    vec2 at = d.xy / (d.z + 0.12);
    float cloud = texture2D(uNoise, at / 5.0).b * 0.6 + texture2D(uNoise, at.yx / 2.1 + 0.3).b * 0.4;
    float share = smoothstep(0.50, 0.72, cloud) * smoothstep(0.02, 0.22, d.z);
    sky = mix(sky, uHorizon * 1.15 + 0.3 * uGlow, 0.75 * share);
    sky += uGlow * 60.0 * smoothstep(0.99985, 0.99995, dot(d, uSunWorld)) * (1.0 - share) * step(0.0, d.z);
    gl_FragColor = vec4(developed(sky), 1.0);
    #include <colorspace_fragment>
    #else
    vec3 horizon = vec3(0.925, 0.938, 0.945), zenith = vec3(0.545, 0.682, 0.788), below = vec3(0.815, 0.835, 0.842);
    vec3 colour = d.z > 0.0 ? mix(horizon, zenith, pow(d.z, 0.6)) : mix(horizon, below, pow(-d.z, 0.5));
    colour += vec3(0.10, 0.08, 0.04) * pow(max(dot(d, uMapSun), 0.0), 6.0);
    gl_FragColor = vec4(colour, 1.0);
    #endif
  }
`;

export class Sky {
  readonly sun = new DirectionalLight(0xfff2df, 3.5);
  /** Towards the sun of the present look. */
  readonly towards = mapSun.clone();
  private readonly fill = new HemisphereLight(0xdfeaf5, 0xb3a48e, 1.75);
  private readonly dome: Mesh;
  private solids: Box3 | null = null;
  private trees: Box3 | null = null;
  private natural = false;

  constructor(scene: Scene, private readonly daylight: Daylight) {
    this.dome = new Mesh(
      new SphereGeometry(1, 32, 24),
      forLook(new ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, side: BackSide, depthWrite: false,
        uniforms: { ...daylight.uniforms, uMapSun: { value: mapSun } } }), daylight.uniforms.uNatural),
    );
    this.dome.frustumCulled = false;
    this.dome.renderOrder = -10;
    this.fill.position.set(0, 0, 1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.bias = -0.0004;
    this.sun.shadow.normalBias = 0.15;
    scene.add(this.dome, this.fill, this.sun, this.sun.target);
  }
  /** Light of a look. Shadows are due after it. */
  shine(natural: boolean): void {
    const { sun, sky } = this.daylight.light;
    if (natural) {
      this.sun.color.copy(sun);
      this.fill.color.copy(sky);
      this.fill.groundColor.copy(sky).multiplyScalar(0.3);
    } else {
      this.sun.color.set(0xfff2df);
      this.fill.color.set(0xdfeaf5);
      this.fill.groundColor.set(0xb3a48e);
    }
    this.sun.intensity = natural ? 1 : 3.5;
    this.fill.intensity = natural ? 1 : 1.75;
    this.towards.copy(natural ? this.daylight.towards : mapSun);
    this.natural = natural;
    this.aimAgain();
  }
  /** Makes shadows as sharp as the extent of the solids allows, and of the trees that the natural look has. */
  aim(solids: Box3, trees: Box3): void {
    this.solids = solids;
    this.trees = trees;
    this.aimAgain();
  }
  private aimAgain(): void {
    if (!this.solids || !this.trees) return;
    const all = this.natural ? this.solids.clone().union(this.trees) : this.solids;
    // Beyond, those of houses would be blurred.
    const solids = this.solids.isEmpty() || all.getSize(new Vector3()).length() < widestShadows_m ? all : this.solids;
    const middle = solids.getCenter(new Vector3());
    this.sun.castShadow = !solids.isEmpty();
    // A light needs a direction also where it has nothing to cast a shadow of.
    const reach = solids.isEmpty() ? 100 : solids.getSize(new Vector3()).length() / 2 + 25;
    this.sun.target.position.copy(middle);
    this.sun.position.copy(middle).addScaledVector(this.towards, 2 * reach);
    const camera = this.sun.shadow.camera;
    camera.left = camera.bottom = -reach;
    camera.right = camera.top = reach;
    camera.near = 0.1;
    camera.far = 4 * reach;
    camera.updateProjectionMatrix();
  }
}

// Shaders of rocks and spray. A particle keeps its number in the buffer, so that the same ones are always rocks.
import { airHead } from "./daylight";
import { particleHead, particlePlace } from "../debris";

const chance = /* glsl */ `
  float chance(int seed) {
    uint h = (uint(gl_VertexID) + uint(seed) * 7919u) * 0x9e3779b1u;
    h = (h ^ (h >> 15)) * 0x85ebca6bu;
    return float((h ^ (h >> 13)) & 0xffffu) / 65535.0;
  }
`;
const outside = "gl_Position = vec4(2.0, 2.0, 2.0, 1.0); gl_PointSize = 0.0;";

export const rocksVertex = /* glsl */ `
  ${particleHead}
  ${chance}
  varying float vSeed, vRoll, vTurned;
  varying vec3 vPlace;
  void main() {
    // One of some thirty, small ones far more often than large ones.
    if (chance(1) > 0.032) { ${outside} return; }
    ${particlePlace}
    if (!shown) { ${outside} return; }
    float size = uDiameter * (0.7 + 1.9 * pow(chance(2), 5.0));
    place.z += 0.15 * size;
    vSeed = chance(3);
    vTurned = 6.28 * chance(4);
    // It rolls as far as it moves.
    vRoll = (place.x + 0.7 * place.y) / size;
    vPlace = place;
    vec4 seen = modelViewMatrix * vec4(place, 1.0);
    gl_Position = projectionMatrix * seen;
    gl_PointSize = 1.3 * size * uPixels / (projectionMatrix[3][3] > 0.5 ? 1.0 : -seen.z);
    if (gl_PointSize < 0.8) { ${outside} }
  }
`;

export const rocksFragment = /* glsl */ `
  #include <common>
  ${airHead}
  uniform vec3 uSun;
  varying float vSeed, vRoll, vTurned;
  varying vec3 vPlace;
  void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    at.y = -at.y;
    float c = cos(vTurned), s = sin(vTurned);
    vec2 turned = mat2(c, s, -s, c) * at;
    // A broken stone: an ellipse cut by a few planes.
    turned.y *= 1.15 + 0.5 * vSeed;
    float edge = 0.92;
    vec2 tilt = vec2(0.0);
    for (int k = 0; k < 5; ++k) {
      float angle = 1.257 * float(k) + 5.0 * fract(vSeed * (7.0 + float(k))) * 0.2;
      vec2 out_ = vec2(cos(angle), sin(angle));
      float over = dot(turned, out_) - 0.34 - 0.25 * fract(vSeed * (3.7 + 2.0 * float(k)));
      if (over > 0.0) tilt += out_ * 0.75;
      edge = min(edge, 0.92 - 0.28 * step(0.3, over) * fract(vSeed * 5.0 + 0.31 * float(k)));
    }
    float r2 = dot(turned, turned);
    if (r2 > edge * edge) discard;
    vec3 normal = normalize(vec3(mat2(c, -s, s, c) * (0.45 * turned + tilt), 0.75 * sqrt(1.0 - r2) + 0.1));
    float grain = texture2D(uNoise, (turned + vec2(vSeed * 9.0, 0.4 * vRoll)) * 0.21).b;
    vec3 stone = mix(vec3(0.095, 0.082, 0.066), vec3(0.20, 0.180, 0.150), fract(vSeed * 13.0)) * (0.6 + 0.8 * grain);
    // Mud sticks to its lower side.
    stone = mix(vec3(0.055, 0.040, 0.027), stone, smoothstep(-0.55, 0.25, at.y + 0.5 * (grain - 0.5)));
    float up = 0.6 + 0.4 * at.y;
    vec3 colour = stone * RECIPROCAL_PI * (uSunLight * max(dot(normal, uSun), 0.0) + uSkyLight * up);
    gl_FragColor = vec4(developed(throughAir(colour, vPlace - cameraPosition)), 1.0);
    #include <colorspace_fragment>
  }
`;

export const sprayVertex = /* glsl */ `
  ${particleHead}
  ${chance}
  uniform float uFlowTime;
  varying float vStrength, vSeed;
  varying vec3 vPlace;
  void main() {
    if (chance(5) > 0.16) { ${outside} return; }
    ${particlePlace}
    float strength = smoothstep(5.0, 13.0, speed);
    if (!shown || strength <= 0.0) { ${outside} return; }
    // Thrown up again and again, each drop in its own rhythm.
    float phase = fract(chance(6) + 1.1 * uFlowTime);
    float angle = 6.28 * chance(7);
    place.xy += 0.9 * strength * phase * vec2(cos(angle), sin(angle));
    place.z += strength * (0.4 + 6.0 * chance(8) * phase * (1.0 - phase));
    vSeed = chance(9);
    vStrength = strength * (1.0 - phase) * smoothstep(0.0, 0.15, phase);
    vPlace = place;
    vec4 seen = modelViewMatrix * vec4(place, 1.0);
    gl_Position = projectionMatrix * seen;
    gl_PointSize = (0.5 + 1.6 * phase) * uDiameter * uPixels / (projectionMatrix[3][3] > 0.5 ? 1.0 : -seen.z);
  }
`;

export const sprayFragment = /* glsl */ `
  #include <common>
  ${airHead}
  varying float vStrength, vSeed;
  varying vec3 vPlace;
  void main() {
    vec2 at = 2.0 * gl_PointCoord - 1.0;
    float ragged = texture2D(uNoise, at * 0.09 + vSeed * 7.0).b;
    float share = vStrength * smoothstep(1.0, 0.1, length(at) + 0.9 * (ragged - 0.4)) * 0.55;
    if (share < 0.01) discard;
    vec3 colour = vec3(0.20, 0.165, 0.13) * RECIPROCAL_PI * (0.7 * uSunLight + uSkyLight);
    gl_FragColor = vec4(developed(throughAir(colour, vPlace - cameraPosition)), share);
    #include <colorspace_fragment>
  }
`;

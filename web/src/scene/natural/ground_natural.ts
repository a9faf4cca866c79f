// Natural look of the ground: rock, soil and plants by slope, the wet trail of the debris, and the debris itself as lit mud.
// Inserted into three.js's Lambert shader after the code of ground_shader.ts.
import { airHead } from "./daylight";

const head = /* glsl */ `
  #ifdef NATURAL
  ${airHead}
  uniform sampler2D uTrail, uShade;
  uniform vec4 uTrailPlacing, uShadePlacing;
  uniform float uFlowTime, uPhotoGain, uSea;
  struct Surface {
    vec3 albedo;
    vec2 slope;   // of what is finer than the mesh
    float wet;
    float mud;    // share of debris
  };
  Surface natural = Surface(vec3(0.0), vec2(0.0), 0.0, 0.0);
  float naturalOpen = 1.0;

  // Noise of a size in metres: slope in xy, value (0 to 1) in z, distance to the nearest of scattered points in w.
  vec4 noiseAt(vec2 at, float size) {
    vec4 n = texture2D(uNoise, at / size);
    return vec4((n.xy - 0.5) * 25.6 / size, n.zw);
  }

  // turn: cosine and sine of an angle.
  vec2 turned(vec2 at, vec2 turn) {
    return vec2(turn.x * at.x - turn.y * at.y, turn.y * at.x + turn.x * at.y);
  }

  // Smooth between cells: a cubic B-spline from four filtered readings (Sigg and Hadwiger 2005).
  vec2 smoothIn(sampler2D map, vec4 placing, vec2 at) {
    vec2 size = vec2(textureSize(map, 0));
    vec2 cell = (at - placing.xy) * placing.zw * size - 0.5;
    if (placing.z <= 0.0 || any(lessThan(cell, vec2(-1.5))) || any(greaterThan(cell, size + 0.5))) return vec2(0.0);
    vec2 i = floor(cell), f = cell - i, g = 1.0 - f;
    vec2 w0 = g * g * g / 6.0, w1 = (4.0 - 6.0 * f * f + 3.0 * f * f * f) / 6.0, w3 = f * f * f / 6.0;
    vec2 low = w0 + w1, high = 1.0 - low;
    vec2 a = (i - 0.5 + w1 / low) / size, b = (i + 1.5 + w3 / high) / size;
    return low.y * (low.x * texture2D(map, a).rg + high.x * texture2D(map, vec2(b.x, a.y)).rg)
         + high.y * (low.x * texture2D(map, vec2(a.x, b.y)).rg + high.x * texture2D(map, b).rg);
  }
  vec2 smoothFlowAt(vec2 at) {
    if (uDetail < 0.5) return flowAt(at);
    return mix(smoothIn(uDepth0, uPlacing0, at), smoothIn(uDepth1, uPlacing1, at), uDepthMix);
  }

  void lay(inout Surface under, vec3 albedo, vec2 slope, float wet, float share) {
    under.albedo = mix(under.albedo, albedo, share);
    under.slope = mix(under.slope, slope, share);
    under.wet = mix(under.wet, wet, share);
  }

  Surface bareGround(vec3 at, vec3 n) {
    // A tile repeats. Two wide ones, smooth and turned, bend the narrower ones and are themselves nowhere in step: no two copies of a tile look alike.
    vec2 pixelX = dFdx(at.xy), pixelY = dFdy(at.xy);
    float pixel = sqrt(max(dot(pixelX, pixelX), dot(pixelY, pixelY)));
    float lod = max(3.0, log2(1.5 * pixel));
    float wide = textureLod(uNoise, turned(at.xy, vec2(0.921, 0.390)) / 173.0, lod).z, wider = textureLod(uNoise, turned(at.xy, vec2(0.454, -0.891)) / 287.0, lod).z;
    vec4 middle = noiseAt(turned(at.xy, vec2(0.788, 0.616)) + 34.0 * vec2(wide - 0.5, wider - 0.5), 37.0);
    vec4 fine = noiseAt(at.xy + 4.5 * vec2(middle.z - 0.5, wide - 0.5), 7.3), grain = vec4(0.0, 0.0, 0.5, 0.5);
    // Where a pixel holds much of a tile there is only its mean to see.
    if (uDetail > 1.5 && pixel < 0.4) {
      grain = textureGrad(uNoise, (at.yx + 0.9 * (fine.z - 0.5)) / 1.9, pixelX.yx / 1.9, pixelY.yx / 1.9);
      grain.xy = (grain.xy - 0.5) * 25.6 / 1.9;
    }
    wide += 0.6 * (wider - 0.5);
    vec2 rough = 0.35 * fine.xy + 0.12 * grain.yx;
    float steep = 1.0 - n.z + 0.10 * (middle.z - 0.5) + 0.06 * (fine.z - 0.5);
    vec3 grass = mix(vec3(0.066, 0.088, 0.032), vec3(0.165, 0.148, 0.072), smoothstep(0.35, 0.72, wide + 0.5 * (fine.z - 0.5)));
    Surface s = Surface(grass * (0.75 + 0.5 * grain.z), rough, 0.0, 0.0);
    // Shrubs where the slope holds them: thickets with soft edges, and few between them.
    float thicket = smoothstep(0.42, 0.62, wide + 0.5 * (middle.z - 0.5));
    float shrub = smoothstep(0.46, 0.20, middle.w + 0.30 * (fine.z - 0.5) + 0.45 * (0.5 - thicket));
    lay(s, vec3(0.034, 0.052, 0.020) * (0.5 + fine.z + 0.5 * grain.z), 1.3 * rough, 0.0, (0.1 + 0.72 * thicket) * shrub * smoothstep(0.30, 0.2, steep));
    float soil = smoothstep(0.17, 0.25, steep + 0.10 * (wide - 0.5)) * smoothstep(0.40, 0.62, fine.z + 0.6 * (middle.z - 0.35));
    lay(s, mix(vec3(0.20, 0.128, 0.070), vec3(0.27, 0.20, 0.13), grain.z), 1.4 * rough, 0.0, 0.85 * soil);
    float rock = smoothstep(0.27, 0.34, steep);
    if (rock > 0.0 && uDetail > 0.5) {
      vec4 beds = texture2D(uNoise, vec2(at.x + at.y, 2.2 * at.z) / 23.0);
      lay(s, mix(vec3(0.11, 0.105, 0.095), vec3(0.30, 0.285, 0.255), beds.z * 0.7 + grain.z * 0.3), 2.2 * rough + (beds.xy - 0.5), 0.0, rock);
    }
    return s;
  }

  // Models of the ground have the sea as level ground at 0 m, or a little below.
  void laySea(inout Surface s, vec3 at, vec3 n) {
    float sea = uSea * smoothstep(0.3, 0.1, at.z + uOriginZ) * smoothstep(0.9990, 0.9999, n.z);
    if (sea > 0.0) lay(s, vec3(0.012, 0.034, 0.046), 0.03 * noiseAt(at.xy, 11.0).xy + 0.02 * noiseAt(at.yx, 3.1).xy, 0.9, sea);
  }

  // Earth that debris has run over: stripped of plants, paler than grass and shrubs and than the mud itself, strewn with what it left.
  void layTrail(inout Surface s, vec2 at) {
    vec2 uv = (at - uTrailPlacing.xy) * uTrailPlacing.zw;
    if (uTrailPlacing.z <= 0.0 || any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) return;
    float peak = 5.0 * texture2D(uTrail, uv).r;
    if (peak <= 0.0) return;
    vec4 middle = noiseAt(at, 9.0), fine = noiseAt(at.yx, 2.3);
    float share = smoothstep(0.03, 0.22, peak + 0.22 * (middle.z - 0.5));
    vec3 earth = mix(vec3(0.250, 0.186, 0.122), vec3(0.345, 0.268, 0.184), smoothstep(0.35, 0.7, fine.z));
    // Damp in its hollows, with stones.
    earth *= 0.62 + 0.38 * smoothstep(0.30, 0.55, middle.z);
    float stones = smoothstep(0.26, 0.18, fine.w) * smoothstep(0.45, 0.6, middle.z);
    earth = mix(earth, vec3(0.30, 0.28, 0.25), 0.6 * stones);
    lay(s, earth, 0.5 * middle.xy + 0.35 * fine.yx, 0.12, 0.94 * share);
  }

  // The debris: wet mud far darker than any ground, so that it is found on grass, soil, rock and photos alike, in the sun and in the shade.
  // A pale margin of splashes where it is thin, pale crests where it is fast, and at the front, where it pushes stones before it. Its ripples move with it.
  float layMud(inout Surface s, vec2 at, vec3 n) {
    vec2 flow = smoothFlowAt(at);
    if (flow.x <= 0.004) return 0.0;
    float e = 0.5;
    vec2 slope = vec2(smoothFlowAt(at + vec2(e, 0.0)).x - smoothFlowAt(at - vec2(e, 0.0)).x,
                      smoothFlowAt(at + vec2(0.0, e)).x - smoothFlowAt(at - vec2(0.0, e)).x) / (2.0 * e);
    vec2 down = n.xy / max(length(n.xy), 0.08);
    float turn = uFlowTime / 1.4, lasts = 1.4;
    float first = fract(turn), second = fract(turn + 0.5);
    vec2 shift = down * flow.y * lasts;
    vec4 a = noiseAt(at - shift * (first - 0.5), 6.1), b = noiseAt(at - shift * (second - 0.5) + 3.3, 6.1);
    vec4 lumps = mix(a, b, abs(2.0 * first - 1.0));
    vec4 c = noiseAt(at.yx - shift.yx * (first - 0.5), 1.7), d = noiseAt(at.yx - shift.yx * (second - 0.5) + 1.1, 1.7);
    vec4 fine = mix(c, d, abs(2.0 * first - 1.0));
    float fast = smoothstep(1.5, 9.0, flow.y);
    float thick = 1.0 - exp(-flow.x / 0.2);
    vec3 mud = mix(vec3(0.046, 0.029, 0.015), vec3(0.020, 0.0112, 0.0052), thick);
    mud *= 0.8 + 0.4 * fine.z;
    float crests = 0.55 * fast * smoothstep(0.56, 0.74, 0.6 * lumps.z + 0.4 * fine.z);
    mud = mix(mud, vec3(0.25, 0.19, 0.125), crests);
    // At rest it is as dark; only its film of water is gone.
    float moving = smoothstep(0.05, 0.8, flow.y);
    float margin = smoothstep(0.11, 0.04, flow.x + 0.05 * (fine.z - 0.5)) * (0.35 + 0.65 * moving);
    mud = mix(mud, vec3(0.30, 0.23, 0.155), 0.8 * margin);
    float share = smoothstep(0.02, 0.10, flow.x + 0.06 * (fine.z - 0.5));
    lay(s, mud, slope + (0.30 + 0.4 * fast) * lumps.xy + (0.08 + 0.18 * fast) * fine.yx, (0.25 + 0.6 * moving) * (1.0 - 0.8 * margin), share);
    s.mud = max(s.mud, share * (1.0 - margin));
    return share;
  }
  #endif
`;

/** Before the lights: what the ground is made of here. */
const colour = /* glsl */ `
  #ifdef NATURAL
  {
    vec3 n = normalize(vGroundNormal);
    if (vShade < 0.0) {
      float bed = texture2D(uNoise, vec2(vLocal.x + vLocal.y, 3.0 * vLocal.z) / 60.0).z;
      natural.albedo = mix(vec3(0.10, 0.075, 0.052), vec3(0.19, 0.155, 0.12), bed);
      naturalOpen = 0.75;
    } else {
      natural = bareGround(vLocal, n);
      laySea(natural, vLocal, n);
      naturalOpen = 0.25 + 0.75 * smoothstep(0.30, 0.95, vShade);
      if (uPhotoShown > 0.5) {
        vec4 photo = texture2D(uPhoto, (vLocal.xy - uPhotoPlacing.xy) * uPhotoPlacing.zw);
        lay(natural, photo.rgb * uPhotoGain, vec2(0.0), 0.0, photo.a);
      }
      vec4 over = areaIn(uOver, uOverPlacing);
      lay(natural, over.rgb * 0.5, vec2(0.0), 0.0, over.a);
      layTrail(natural, vLocal.xy);
      layMud(natural, vLocal.xy, n);
    }
    diffuseColor.rgb = natural.albedo;
  }
  #endif
`;

const normal = /* glsl */ `
  #ifdef NATURAL
  if (vShade >= 0.0) {
    vec3 ground = normalize(vGroundNormal);
    normal = normalize((viewMatrix * vec4(normalize(vec3(ground.xy / max(ground.z, 0.05) - natural.slope, 1.0)), 0.0)).xyz);
  }
  #endif
`;

/** After the lights: shade of the hills, open sky, gloss of what is wet, air. */
const light = /* glsl */ `
  #ifdef NATURAL
  {
    vec2 shadeAt = (vLocal.xy - uShadePlacing.xy) * uShadePlacing.zw;
    float sunny = uShadePlacing.z > 0.0 ? texture2D(uShade, shadeAt).r : 1.0;
    vec3 worldNormal = normalize((vec4(normal, 0.0) * viewMatrix).xyz);
    vec3 sight = vLocal - cameraPosition;
    vec3 towards = isOrthographic ? vec3(0.0, 0.0, 1.0) : -normalize(sight);
    float facing = max(dot(worldNormal, uSunWorld), 0.0);
    vec3 expected = natural.albedo * uSunLight * facing * RECIPROCAL_PI;
    float lit = sunny * clamp(dot(reflectedLight.directDiffuse, vec3(1.0)) / max(dot(expected, vec3(1.0)), 1e-5), 0.0, 1.0);
    outgoingLight = reflectedLight.directDiffuse * sunny + reflectedLight.indirectDiffuse * naturalOpen;
    if (natural.wet > 0.02) {
      vec3 middle = normalize(uSunWorld + towards);
      // Mud scatters what it mirrors: broad lights instead of sharp ones, and a brown cast, since the blue of the sky on brown is purple.
      float gloss = mix(90.0, 22.0, natural.mud);
      float grazing = pow(1.0 - max(dot(worldNormal, towards), 0.0), 5.0);
      float mirror = mix(0.05 + 0.6 * grazing, 0.018 + 0.3 * grazing, natural.mud);
      float spot = pow(max(dot(worldNormal, middle), 0.0), gloss) * (gloss + 8.0) / 25.0;
      vec3 film = mix(vec3(1.0), vec3(1.0, 0.70, 0.42), natural.mud);
      outgoingLight += natural.wet * film * (lit * facing * uSunLight * spot * mix(0.06, 0.16, natural.mud) + naturalOpen * mirror * skyTowards(reflect(-towards, worldNormal)));
    }
    outgoingLight = developed(throughAir(outgoingLight, sight));
  }
  #endif
`;

export const naturalGround = { head, colour, normal, light };

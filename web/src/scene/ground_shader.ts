// Code inserted into three.js's Lambert shader for the ground.

export const sharedHead = /* glsl */ `
  uniform sampler2D uDepth0, uDepth1;
  uniform vec4 uPlacing0, uPlacing1;
  uniform float uDepthMix, uSurface;
  vec2 flowIn(sampler2D map, vec4 placing, vec2 at) {
    vec2 uv = (at - placing.xy) * placing.zw;
    bool inside = placing.z > 0.0 && all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
    return inside ? texture2D(map, uv).rg : vec2(0.0);
  }
  // Depth (m) and depth-averaged speed (m/s).
  vec2 flowAt(vec2 at) {
    return mix(flowIn(uDepth0, uPlacing0, at), flowIn(uDepth1, uPlacing1, at), uDepthMix);
  }
`;

const vertexHead = /* glsl */ `
  attribute float shade;
  uniform sampler2D uSunk;
  uniform vec4 uSunkPlacing;
  uniform float uCell;
  varying float vShade;
  varying vec3 vLocal;
  varying vec3 vGroundNormal;
  // Depth of erosion (m).
  float sunkAt(vec2 at) {
    vec2 uv = (at - uSunkPlacing.xy) * uSunkPlacing.zw;
    bool inside = all(greaterThan(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
    return inside ? texture2D(uSunk, uv).r : 0.0;
  }
`;

const vertexNormal = /* glsl */ `
  if (uSunkPlacing.z > 0.0 && shade >= 0.0) {
    vec2 steeper = vec2(sunkAt(position.xy + vec2(uCell, 0.0)) - sunkAt(position.xy - vec2(uCell, 0.0)),
                        sunkAt(position.xy + vec2(0.0, uCell)) - sunkAt(position.xy - vec2(0.0, uCell))) / (2.0 * uCell);
    objectNormal = normalize(vec3(normal.xy / normal.z + steeper, 1.0));
  }
`;

const vertexPlace = /* glsl */ `
  if (uSunkPlacing.z > 0.0) transformed.z -= sunkAt(position.xy);
  vShade = shade;
  vLocal = transformed;
  vGroundNormal = objectNormal;
  #ifndef NATURAL
  if (uSurface > 0.5)
  #endif
  transformed.z += flowAt(position.xy).x * step(0.0, shade);
`;

export const groundVertex = { head: vertexHead, normal: vertexNormal, place: vertexPlace };

const head = /* glsl */ `
  uniform sampler2D uGroundRamp, uSurfaceRamp, uLayer, uLayerRamp, uDrawn, uWide, uPhoto, uOver;
  uniform vec2 uElevation, uLayerRange;
  uniform vec4 uLayerPlacing, uDrawnPlacing, uWidePlacing, uPhotoPlacing, uOverPlacing;
  uniform float uPhotoShown, uOriginZ, uContourInterval, uContour, uSurfaceBySpeed, uSurfaceTop, uLayerOpacity;
  varying float vShade;
  varying vec3 vLocal;
  varying vec3 vGroundNormal;
  float lineAt(float at, float width) {
    float gap = abs(fract(at - 0.5) - 0.5);
    float pixel = fwidth(at);
    // Lines closer than a few pixels fade into grey instead of flickering.
    return (1.0 - smoothstep(width * pixel, (width + 1.0) * pixel, gap)) * (1.0 - smoothstep(0.12, 0.35, pixel));
  }
  vec4 areaIn(sampler2D picture, vec4 placing) {
    vec2 at = (vLocal.xy - placing.xy) * placing.zw;
    bool inside = placing.z > 0.0 && all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0)));
    return inside ? texture2D(picture, at) : vec4(0.0);
  }
  float flowCover = 0.0;
`;

// Of the natural look: natural/ground_natural.ts.
const colour = /* glsl */ `
  #ifndef NATURAL
  if (vShade < 0.0) {
    // Side walls: faint layers, darker towards the floor.
    float down = clamp((vLocal.z - uElevation.x) / uElevation.y, -0.3, 1.0);
    diffuseColor.rgb = mix(vec3(0.36, 0.34, 0.32), vec3(0.50, 0.475, 0.44), down + 0.3) * 0.9;
  } else {
    float share = clamp((vLocal.z - uElevation.x) / uElevation.y, 0.002, 0.998);
    vec3 ground = texture2D(uGroundRamp, vec2(share, 0.5)).rgb;
    float steep = 1.0 - normalize(vGroundNormal).z;
    ground = mix(ground, vec3(0.56, 0.515, 0.46), 0.7 * smoothstep(0.16, 0.5, steep));
    float open = 0.34 + 0.66 * smoothstep(0.38, 0.94, vShade);
    ground *= open;
    if (uPhotoShown > 0.5) {
      // A photograph contains shading: that of the relief only deepens it slightly.
      vec4 photo = texture2D(uPhoto, (vLocal.xy - uPhotoPlacing.xy) * uPhotoPlacing.zw);
      ground = mix(ground, photo.rgb * (0.7 + 0.3 * open), photo.a);
    }
    vec4 over = areaIn(uOver, uOverPlacing);
    ground = mix(ground, over.rgb * (0.75 + 0.25 * open), over.a);
    vec4 wide = areaIn(uWide, uWidePlacing);
    ground = mix(ground, wide.rgb, wide.a);
    vec4 drawn = areaIn(uDrawn, uDrawnPlacing);
    ground = mix(ground, drawn.rgb, drawn.a);
    float z = (vLocal.z + uOriginZ) / uContourInterval;
    float contour = max(0.30 * lineAt(z, 0.25), 0.55 * lineAt(z / 5.0, 0.55));
    ground = mix(ground, vec3(0.18, 0.13, 0.08), contour * uContour);
    if (uLayerOpacity > 0.0) {
      vec2 at = (vLocal.xy - uLayerPlacing.xy) * uLayerPlacing.zw;
      vec2 held = texture2D(uLayer, at).rg;
      float value = held.r / max(held.g, 1e-4);
      float cover = smoothstep(0.35, 0.65, held.g) * step(0.0, at.x) * step(at.x, 1.0) * step(0.0, at.y) * step(at.y, 1.0);
      float part = clamp((value - uLayerRange.x) / (uLayerRange.y - uLayerRange.x), 0.002, 0.998);
      vec3 tint = texture2D(uLayerRamp, vec2(part, 0.5)).rgb * mix(1.0, open, 0.4);
      ground = mix(ground, tint, cover * uLayerOpacity);
    }
    if (uSurface > 0.5) {
      vec2 flow = flowAt(vLocal.xy);
      flowCover = smoothstep(0.02, 0.10, flow.x);
      float part = (uSurfaceBySpeed > 0.5 ? flow.y : flow.x) / uSurfaceTop;
      vec3 mud = texture2D(uSurfaceRamp, vec2(clamp(part, 0.002, 0.998), 0.5)).rgb;
      ground = mix(ground, mud, flowCover * 0.96);
    }
    diffuseColor.rgb = ground;
  }
  #endif
`;

export const groundFragment = { head, colour };

// Where debris lies as a surface, its own slope is shaded; `normal` is in view space.
export const groundNormal = /* glsl */ `
  #ifndef NATURAL
  if (uSurface > 0.5 && vShade >= 0.0) {
    float e = 0.7;
    vec2 slope = vec2(flowAt(vLocal.xy + vec2(e, 0.0)).x - flowAt(vLocal.xy - vec2(e, 0.0)).x,
                      flowAt(vLocal.xy + vec2(0.0, e)).x - flowAt(vLocal.xy - vec2(0.0, e)).x) / (2.0 * e);
    vec3 ground = normalize(vGroundNormal);
    vec3 lifted = normalize(vec3(ground.xy / max(ground.z, 0.05) - slope, 1.0));
    normal = normalize((viewMatrix * vec4(mix(ground, lifted, flowCover), 0.0)).xyz);
  }
  #endif
`;

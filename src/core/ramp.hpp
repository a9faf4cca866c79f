#pragma once

namespace talus {

/// A colour ramp that falls in lightness from its low to its high end by equal perceived steps, so that it is readable
/// with colour blindness and in greyscale. Hue in degrees and chroma of the ends in OKLCh (Ottosson 2020, "A perceptual
/// color space for image processing").
struct Ramp {
    double low_hue = 0, low_chroma = 0, high_hue = 0, high_chroma = 0;
    double low_lightness = 0.93, high_lightness = 0.30;
};

}  // namespace talus

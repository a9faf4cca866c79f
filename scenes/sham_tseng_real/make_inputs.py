#!/usr/bin/env python3
"""Makes the release area, buildings and flow path of the scene on the official terrain model.

    python3 scenes/sham_tseng_real/make_inputs.py [FOLDER]

writes release.geojson, three other shapes of the release to compare (release_lower, _long, _wide), buildings.geojson and
flow_path.geojson into FOLDER (by default the folder of this script).
The houses are those of the built-in scene, all of them assumed. The line and the scar were placed by us on the 5 m
terrain model so that debris takes the recorded trail: see docs/scenes.md. EPSG:2326, metres.
"""

import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "sham_tseng"))
sys.dont_write_bytecode = True

import make_terrain as reconstruction  # noqa: E402

# From the crown down the side hollow to the gully's bend and along the gully's bed into the village.
TRAIL_CORNERS = [reconstruction.CROWN, (824344.0, 825828.5), (824328.0, 825823.5), (824310.0, 825820.0),
                 (824296.0, 825816.0), (824284.0, 825810.5), (824275.0, 825804.0), (824264.0, 825797.0),
                 (824260.0, 825787.0), (824255.0, 825778.0), (824250.0, 825768.0), (824244.0, 825757.0),
                 (824240.0, 825746.0), (824236.0, 825735.0), (824231.0, 825722.0), (824226.0, 825710.0),
                 (824224.0, 825697.0), (824219.0, 825685.0), (824214.0, 825671.0), (824205.0, 825659.0),
                 (824201.0, 825647.0), (824196.0, 825634.0), (824190.0, 825620.0), (824177.0, 825606.0),
                 (824163.0, 825594.0), (824155.0, 825582.0), (824155.0, 825550.0)]
SCAR = {"start": 14.0, "end": 41.0, "width": 18.0}


def main(folder):
    trail = reconstruction.rounded(TRAIL_CORNERS, 3)
    reconstruction.write_vectors(folder, trail, SCAR, "trail of the 1999 landslide, inferred")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else os.path.dirname(os.path.abspath(__file__)))

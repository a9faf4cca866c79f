// What crosses the faces between cells in a stage of the depth-averaged step. Included once per instruction set.
#if defined(TALUS_DEPTH_FACES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TALUS_DEPTH_FACES_INL
#undef TALUS_DEPTH_FACES_INL
#else
#define TALUS_DEPTH_FACES_INL
#endif

#include <hwy/highway.h>

#include "depth/formulas.hpp"
#include "depth/rows-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace talus::depth::HWY_NAMESPACE {

/// Fluxes between entry j of `before` and entry k of `after`; the normal velocity of the axis is u, if `along_x`. If
/// not `built`, no wall there is more than 1: dry ground.
template <class L>
HWY_INLINE void cross_faces(float gravity, bool built, const Row& before, int j, const Row& after, int k, bool along_x,
                            Faces& faces, int to) {
    const AxisRow &b = along_x ? before.x : before.y, &a = along_x ? after.x : after.y;
    const L lift = (load<L>(before.lift, j) + load<L>(after.lift, k)) * L(0.5F);
    // Where the ground bends, the velocity at the face belongs to neither slope: the energy line there lies between
    // those of the cells.
    const L fall = L(gravity) * (load<L>(before.bed, j) - load<L>(after.bed, k));
    const L line_before = load<L>(before.square, j) + fall, line_after = load<L>(after.square, k) - fall;
    const L line = (line_before + line_after) * L(0.5F);
    const auto square = [&](const L& normal, const L& across, const Row& row, int at, const L& own_line) HWY_ATTR {
        const L by_x = along_x ? normal : across, by_y = along_x ? across : normal;
        const L upward = load<L>(row.bed_x, at) * by_x + load<L>(row.bed_y, at) * by_y;
        return smaller(larger(normal * normal + across * across + upward * upward, smaller(own_line, line)),
                       larger(own_line, line));
    };
    const auto side = [&](const L& wave, const SideRow& seen, const Row& row, int at, const L& own_line) HWY_ATTR {
        const L normal = load<L>(seen.normal, at), across = load<L>(seen.across, at);
        const L speed_square = square(normal, across, row, at, own_line);
        return FaceSide<L>{load<L>(seen.depth, at), normal, across, wave, load<L>(seen.limit, at), speed_square, lift};
    };
    FaceSide<L> from = side(load<L>(b.wave, j), b.after, before, j, line_before);
    FaceSide<L> onto = side(load<L>(a.wave, k), a.before, after, k, line_after);
    // Beside dry ground that stands above it, debris sees itself; beside a structure, its mirror image.
    const auto mirror = [&](const L& wall, const FaceSide<L>& of, FaceSide<L>& in) HWY_ATTR {
        in.depth = select(wall > L(0), of.depth, in.depth);
        in.normal = select(wall > L(0), of.normal, in.normal);
        if (built) in.normal = select(wall > L(1), L(0) - of.normal, in.normal);
        in.across = select(wall > L(0), of.across, in.across);
        in.wave = select(wall > L(0), of.wave, in.wave);
        in.square = select(wall > L(0), of.square, in.square);
    };
    // Not both: of two neighbours, a wall is the dry one.
    // Debris on top of a structure falls off, over the debris beside it.
    const auto falls = [](const L& wall, const FaceSide<L>& top) HWY_ATTR {
        return opaque(select(wall > L(1), L(1), L(0))) * opaque(select(top.depth > L(0), L(1), L(0)));
    };
    L falls_after(0), falls_before(0), wall_before = load<L>(a.before.wall, k), wall_after = load<L>(b.after.wall, j);
    if (built) {
        falls_after = falls(wall_before, from);
        falls_before = falls(wall_after, onto);
        wall_before = wall_before * (L(1) - falls_after);
        wall_after = wall_after * (L(1) - falls_before);
    }
    const FaceSide<L> unchanged = from;
    mirror(wall_before, onto, from);
    mirror(wall_after, unchanged, onto);
    if (built) {
        onto.depth = onto.depth * (L(1) - falls_after);
        from.depth = from.depth * (L(1) - falls_before);
    }
    Flux<L> flux = face_flux(from, onto);
    const L open = select(load<L>(before.at_rest, j) * load<L>(after.at_rest, k) > L(0), L(0), L(1));
    // Debris that passes has followed the ground of one cell and meets that of the other: half of the change is felt on
    // either side.
    const L turn_x = load<L>(after.bed_x, k) - load<L>(before.bed_x, j),
            turn_y = load<L>(after.bed_y, k) - load<L>(before.bed_y, j);
    const L turn = along_x ? turn_x * flux.carried_normal + turn_y * flux.carried_across
                           : turn_y * flux.carried_normal + turn_x * flux.carried_across;
    // Nor does debris climb to a face that its energy does not reach.
    const L reach =
        select(flux.mass > L(0), line_before + L(2) * lift * from.depth, line_after + L(2) * lift * onto.depth);
    L passes = opaque(select(reach < L(0), L(0), open));
    L pressure_before = flux.pressure_before * open, pressure_after = flux.pressure_after * open;
    if (built) {
        passes = select(wall_before + wall_after > L(1), L(0), passes);
        pressure_before = pressure_before * (L(1) - falls_before);
        pressure_after = pressure_after * (L(1) - falls_after);
    }
    store(flux.normal * open, faces.normal, to);
    store(flux.across * passes, faces.across, to);
    store(pressure_before, faces.pressure_before, to);
    store(pressure_after, faces.pressure_after, to);
    store(flux.mass * passes, faces.mass, to);
    store(L(0.5F) * flux.mass * turn * passes, faces.press, to);
    const L spare = select(flux.mass > L(0), load<L>(before.spare, j), load<L>(after.spare, k));
    store((flux.energy + flux.mass * spare) * passes, faces.energy, to);
}

/// What goes with the mass across faces whose fluxes are known: the pore pressure of where it comes from, and the solid
/// fraction, if it `evolves`.
template <class L>
HWY_INLINE void cross_faces_with_pore_pressure(const Row& before, int j, const Row& after, int k, bool evolves,
                                               Faces& faces, int to) {
    const L mass = load<L>(faces.mass, to);
    store(mass * select(mass > L(0), load<L>(before.pore_pressure, j), load<L>(after.pore_pressure, k)),
          faces.pore_pressure, to);
    if (!evolves) return;
    store(mass * select(mass > L(0), load<L>(before.solid_fraction, j), load<L>(after.solid_fraction, k)),
          faces.solid_fraction, to);
}

/// The same for debris that flies.
template <class L>
HWY_INLINE void cross_faces_in_flight(const Row& before, int j, const Row& after, int k, Faces& faces, int to) {
    const L mass = load<L>(faces.mass, to);
    store(mass * select(mass > L(0), load<L>(before.height, j), load<L>(after.height, k)), faces.height, to);
    store(mass * select(mass > L(0), load<L>(before.upward, j), load<L>(after.upward, k)), faces.upward, to);
}

}  // namespace talus::depth::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// The pressures that a house has, told in the same words wherever one of them stands.
export const pressures = "Impact pressure (houses, key figures) is the highest force on a patch of a wall, 1 m x 1 m unless the scene says otherwise, over its area. " +
  "Dynamic pressure (maps, points) is density times speed squared of the free flow, which a wall does not stop. Force is that on all walls of a house: over their area it is less than the impact pressure.";

/// The fit of the projection that makes place descriptors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace phasescan {

/// Fits linear discriminants to place features: of all directions those in which places differ most, measured by how
/// much a place and a view from within a metre do. One is fitted to the magnitudes of all features, and one to the
/// rings of each harmonic, turned to one heading: what turns all rings alike leaves its directions as they are.
///
/// Half of the weight is on flats, the rest on offices, corridors and large buildings alike; all are simulated from
/// `seed`. Directions are scaled so that noise counts by what it leaves of the signal, and squared distances are
/// log-likelihood ratios as far as features are normal.
/// @param places  simulated of each kind of building
/// @return  the text of src/slam/place_projection.inc; the same for the same arguments
/// @source  [Fisher36]; Belhumeur, Hespanha, Kriegman 1997 for recognition
/// @cost  about 0.7 ms a place; 1.2 kB a place
std::string fit_place_projection(std::uint64_t seed, std::size_t places,
                                 const std::function<void(std::size_t)>& progress = {});

}  // namespace phasescan

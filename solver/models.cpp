// The register of models: one entry each.
#include <array>

#include <froude/base/error.h>
#include <froude/solver/fluid/dfsph.h>
#include <froude/solver/fluid/grid/apic.h>
#include <froude/solver/fluid/pbf.h>
#include <froude/solver/fluid/wcsph.h>
#include <froude/solver/model_card.h>
#include <froude/solver/world.h>

namespace froude {

std::span<const ModelCard> modelCards() {
  static const std::vector<ModelCard> kCards{
      {"ballistic",
       "Ballistic bullets",
       "discs that fly, bounce and slide on polygons; no interaction among themselves",
       "collisions between bullets, rotation of a bullet, drag",
       {"sqrt(0.8 radius / g): a step's chord departs from the parabola by a tenth of the radius",
        "0.5 rad of spin of a moving polygon"},
       {"after 8 bounces in a sub-step a bullet rests at its last contact and moves with that polygon"},
       {}},
      {"pbf",
       "Position based fluid",
       "incompressible fluid with a free surface by density constraints, walls exact for polygons, free-slip or "
       "no-slip; surface tension with a contact angle",
       "negative pressure; viscosity only as a laminar term, which is also what sticks to no-slip "
       "walls",
       {"courant * support / v_max, courant = 0.6 unless set", "0.25 sqrt(support / g)",
        "dx sqrt(0.15 / (p / density)), p twice the typical pressure sum p^2 / sum p; 0.3 for the largest",
        "0.125 dx^2 / viscosity; where that would halve the step or worse the velocities are solved for, and "
        "0.0025 H^2 / viscosity binds, H the smaller extent of the fluid",
        "0.2 sqrt(density dx^3 / surface tension)", "0.25 * support / speed of a moving polygon",
        "0.5 rad of spin of a moving polygon"},
       {"at most 30 sweeps a step: hit hard, a deep fluid is compressed by several per cent for some steps",
        "the pressure at a single place is up to 3 % of the largest off, by the arrangement of the particles around it",
        "no tension: an accelerated stream breaks up into strands of particles"},
       {"M. Macklin, M. Mueller: Position based fluids. ACM Trans. Graph. 32(4), 2013",
        "J. Bender et al.: Volume maps. SIGGRAPH MIG 2019 (walls); M. Ferrand et al.: Int. J. Numer. Methods Fluids "
        "71, "
        "2013"}},
      {"dfsph",
       "Divergence-free SPH",
       "incompressible fluid with a free surface, pressures below zero inside it, walls exact for polygons, free-slip "
       "or no-slip, laminar viscosity, surface tension with a contact angle",
       "negative pressure at a free surface or a wall",
       {"courant * support / v_max, courant = 0.4 unless set", "0.25 sqrt(support / g)",
        "dx sqrt(0.15 / (p / density)), p twice the typical pressure sum p^2 / sum |p|; 0.3 for the largest",
        "0.125 dx^2 / viscosity; where that would halve the step or worse the velocities are solved for, and "
        "0.0025 H^2 / viscosity binds, H the smaller extent of the fluid",
        "0.2 sqrt(density dx^3 / surface tension)", "0.25 * support / speed of a moving polygon",
        "0.5 rad of spin of a moving polygon"},
       {"rows of particles that a flow shears give way at once: a burst of noise that costs a vortex of 50 spacings a "
        "fifth of its energy, one of 100 a twentieth",
        "at most 100 sweeps a step: a fluid hit hard is compressed by a few per cent for some steps",
        "sub-steps far shorter than the bounds ask for make it noisier, not better: a tank at a seventh of its step "
        "moves at 3 % of sqrt(g depth)",
        "around corners a fluid simmers: single particles at up to a fifth of sqrt(g depth), at needles a third"},
       {"J. Bender, D. Koschier: Divergence-free SPH for incompressible and viscous fluids. IEEE Trans. Vis. Comput. "
        "Graph. 23(3), 2017",
        "X. Hu, N. Adams: An incompressible multi-phase SPH method. J. Comput. Phys. 227, 2007",
        "J. Bonet, T. Lok: Variational and momentum preservation aspects of SPH formulations. Comput. Methods Appl. "
        "Mech. Eng. 180, 1999"}},
      {"wcsph",
       "Weakly compressible SPH",
       "a fluid with a free surface that is a little elastic (sound at ten times the largest speed), walls exact for "
       "polygons, free-slip or no-slip, laminar viscosity, surface tension with a contact angle",
       "incompressibility, cavities",
       {"courant * support / v_max, courant = 0.2 unless set", "0.25 sqrt(support / g)",
        "dx sqrt(0.3 / (p / density)), p twice the typical pressure sum p^2 / sum |p|; 0.6 for the largest",
        "acoustic: a sub-step is at most 64 steps of support / 2 / (c + v)", "0.2 sqrt(density dx^3 / surface tension)",
        "0.125 (support / 2)^2 / viscosity; where that would halve the step or worse the velocities are solved for",
        "0.25 * support / speed of a moving polygon", "0.5 rad of spin of a moving polygon"},
       {"a fluid at rest over steps and corners moves at 2 % of sqrt(g depth) where 20 spacings are deep, at half a "
        "per "
        "cent where 40 are",
        "a free fluid in tension clumps: the rotating square patch loses three hundredths of its area",
        "a fluid that sways is noisy at its floor"},
       {"M. Antuono et al.: Free-surface flows solved by means of SPH schemes with numerical diffusive terms. Comput. "
        "Phys. Commun. 181, 2010",
        "P. Sun et al.: The delta-plus-SPH model. Comput. Methods Appl. Mech. Eng. 315, 2017",
        "H. Wendland: Piecewise polynomial, positive definite and compactly supported radial functions. Adv. Comput. "
        "Math. 4, 1995"}},
      {"apic",
       "Affine particle-in-cell",
       "incompressible fluid with a free surface: particles on a grid of two spacings, one global pressure solve a "
       "step, "
       "polygons as exact cut cells, free-slip or no-slip, implicit viscosity",
       "surface tension, negative pressure at a free surface",
       {"courant * 2 spacing / v_max, courant = 5 unless set, gravity's share of the speed included",
        "0.25 * support / speed of a moving polygon", "0.5 rad of spin of a moving polygon"},
       {"two sides of a plate thinner than a cell feel each other's velocities",
        "drops that meet in mid-air press blocks of cells together for a step or two",
        "what fills less than half of a cell flies without pressure"},
       {"C. Jiang et al.: The affine particle-in-cell method. ACM Trans. Graph. 34(4), 2015",
        "C. Batty, F. Bertails, R. Bridson: A fast variational framework for accurate solid-fluid coupling. ACM Trans. "
        "Graph. 26(3), 2007",
        "Y. T. Ng, C. Min, F. Gibou: An efficient fluid-solid coupling algorithm for single-phase flows. J. Comput. "
        "Phys. 228, 2009"}},
      {"rigid",
       "Rigid bodies",
       "free polygons, concave ones too: contacts with Coulomb friction and Newton's restitution, hinges to the world, "
       "motors, sleep; pushed by bullets, inside the pressure iterations of a fluid",
       "deformation, rolling friction, joints between bodies, periodic sides",
       {"0.5 thickness / speed of a free body, not below 1/960 s; impacts are found beyond it",
        "sub-steps of at most 1/240 s inside a step"},
       {"one iteration of contacts a sub-step, up to 8 where something overruns: heaps thrown together overlap for "
        "some "
        "steps",
        "a rolling polygon of n sides is braked by pi/n of its weight",
        "bullets that outweigh the body which they hit in a sub-step: steps are undone and halved, then the run ends",
        "the last row of particles in a gap narrower than 0.8 spacings bears nothing, and is crushed when the gap "
        "shuts",
        "a full closed tank first takes up the 2 % by which pbf lets a fluid be compressed"},
       {"M. Lin, J. Canny: A fast algorithm for incremental distance calculation. ICRA 1991",
        "M. Macklin et al.: Small steps in physics simulation. SCA 2019"}},
      {"neo-hookean",
       "Soft bodies, neo-Hookean",
       "deformable solids of stable neo-Hookean rubber in plane strain, contact with polygons, free bodies, each other "
       "and "
       "themselves, friction, tearing, inner pressure; fluids by their particles",
       "plasticity, inner viscosity, joints, periodic sides, contact with bullets; the pressure of a fluid next to the "
       "skin",
       {"1/240 s, and spacing / v_max; inside: half of 2 / omega of the stiffest element"},
       {"bends 7 % too stiffly with four points across at nu = 0.45, 2 % at 0.3",
        "solids that overlap by more than half an edge stay together",
        "velocities are those of half a part before: the energy of a hard blow reads a per cent off"},
       {"M. Macklin, M. Mueller: A constraint-based formulation of stable neo-Hookean materials. MIG 2021",
        "M. Macklin et al.: Small steps in physics simulation. SCA 2019",
        "G. Liu, T. Nguyen-Thoi, K. Lam: An edge-based smoothed finite element method. J. Sound Vib. 320, 2009"}},
      {"stvk",
       "Soft bodies, St Venant-Kirchhoff",
       "as neo-hookean, with a stress linear in Green's strain",
       "strong compression: below a stretch of 0.58 it softens, and a triangle that is inside out resists nothing",
       {"as neo-hookean"},
       {"as neo-hookean"},
       {"M. Macklin, M. Mueller, N. Chentanez: XPBD. MIG 2016"}},
      {"shape-matching",
       "Soft bodies, shape matching",
       "deformable solids drawn to the best fit of their rest shape, in overlapping clusters",
       "a stiffness that Young's modulus and Poisson's ratio would predict",
       {"as neo-hookean, with omega of the clusters' springs"},
       {"what bends more than a cluster can is stiffer or softer with the clusters' side of six spacings"},
       {"M. Mueller et al.: Meshless deformations based on shape matching. ACM Trans. Graph. 24(3), 2005"}},
      {"springs",
       "Soft bodies, springs",
       "nets of springs along the edges of triangles, with an area term where nu is above 1/4",
       "nu below 1/4; stiffness is right on equilateral triangles, 8 % off on others",
       {"as neo-hookean, with omega of the springs"},
       {"a net that is compressed buckles inside"},
       {"M. Ostoja-Starzewski: Lattice models in micromechanics. Appl. Mech. Rev. 55, 2002"}},
      {"rope",
       "Ropes",
       "chains that resist stretching (E thickness) and bending (E thickness^3 / 12)",
       "torsion, joints to bodies",
       {"as neo-hookean, with omega = 2 sqrt(E / density) / link and that of bending"},
       {"a stiff rope of short links needs very short parts"},
       {"M. Macklin et al.: Small steps in physics simulation. SCA 2019"}},
  };
  return kCards;
}

const ModelCard* findModelCard(std::string_view name) {
  for (const ModelCard& card : modelCards()) {
    if (card.name == name) return &card;
  }
  return nullptr;
}

double supportOf(const FluidDef& def) {
  return (def.model == "wcsph" ? def.compressible.support : kernel::kSupport) * def.spacing;
}

std::unique_ptr<FluidModel> makeFluidModel(const FluidDef& def, const DomainDef& domain, ParticlePool& pool) {
  if (def.model == "pbf") return std::make_unique<Pbf>(def, domain, pool);
  if (def.model == "dfsph") return std::make_unique<Dfsph>(def, domain, pool);
  if (def.model == "wcsph") return std::make_unique<Wcsph>(def, domain, pool);
  if (def.model == "apic") return std::make_unique<Apic>(def, domain, pool);
  throw Error("fluid model '" + def.model + "' is not in this version; this build has: pbf, dfsph, wcsph, apic");
}

std::size_t estimateWorldBytes(const WorldDef& def, std::size_t fluidParticles, std::size_t bullets) {
  // Peak resident memory of the program: dam_speed at 10,000 and 99,856 particles gives 405 bytes a particle for pbf
  // (to 0.35 s), 513 for dfsph (0.03 s), 550 for wcsph (0.1 s), 637 for apic (2 s), and 57 MB besides; 20,000 and
  // 200,000 bullets gave 238 bytes each. State columns, undo copy, scratch, seeds; the image of a checkpoint in memory
  // takes the place of the undo copy.
  constexpr std::size_t kBulletBytes = 240, kFieldBytes = 57'000'000;
  const std::string model = def.fluid ? def.fluid->model : "";
  const std::size_t fluidBytes = model == "apic" ? 640 : model == "wcsph" ? 550 : model == "dfsph" ? 510 : 405;
  return kFieldBytes + fluidBytes * fluidParticles + kBulletBytes * bullets;
}

}  // namespace froude

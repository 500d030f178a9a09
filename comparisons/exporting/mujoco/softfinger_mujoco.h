#ifndef SOFTFINGER_MUJOCO_H
#define SOFTFINGER_MUJOCO_H

/// Torsional friction in MuJoCo that follows the load. MuJoCo keeps the largest torque per newton
/// of a contact constant. For a soft fingertip it is mu e_n(P), and e_n grows with about P^(1/5) to
/// P^(1/3). Here it is set at every step, from the model `fingertip_layer`.
///
/// A geom is listed by a numeric field of the model, which `softfinger apply --to mujoco --plugin`
/// writes:
///
///     <custom><numeric name="softfinger:GEOM" data="R' R'' h E nu"/></custom>
///
/// with the relative radii R' >= R'' > 0 of finger and object in m, the layer's thickness h in m,
/// Young's modulus E in Pa and Poisson's ratio nu. Three further numbers are the finger's own
/// curvature along the contact's axes, in 1/m: xx, yy, xy (default 0: a flat layer).
///
/// How: mj_step calls mjcb_passive after the constraints were made and before they are solved.
/// There friction[2] of each contact of a listed geom becomes mu e_n(P), with mu = friction[0], and
/// what MuJoCo has derived from it (efc_R, efc_D, efc_diagApprox, the diagonal of efc_AR) follows.
/// P is the normal force of the pair of geoms, all its contact points together, in the last solved
/// step: the present one is not known before the step is solved. e_n thus lags by one step, and the
/// torque is off by about a third of the relative change of P within a step. A pair that touches
/// for the first time has the friction of the file for one step.
///
/// C functions, for C, C++ and what can call a shared library. The geoms need condim 4 or 6, and
/// the model cone="elliptic". Without passive forces (flag passive="disable") mjcb_passive is not
/// called. Made for MuJoCo 2.2, where a step's forces stay readable until the next one is solved;
/// softfinger_torsion.h is for others.

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define SOFTFINGER_MUJOCO_API __attribute__((visibility("default")))
#else
#define SOFTFINGER_MUJOCO_API
#endif

struct mjModel_;
struct mjData_;

typedef struct softfinger_mujoco softfinger_mujoco;

/// Reads the listed geoms and tabulates their e_n(P). Returns NULL, with one line in `error`, when
/// the model lists none, or one that cannot be used. `model` must outlive the result.
SOFTFINGER_MUJOCO_API softfinger_mujoco* softfinger_mujoco_create(const struct mjModel_* model,
                                                                  char* error, int error_size);

/// Also takes it out of mjcb_passive.
SOFTFINGER_MUJOCO_API void softfinger_mujoco_free(softfinger_mujoco* plugin);

/// From now on mjcb_passive sets the friction of every mjData of this model; a callback that was
/// there before is called, too. Any number of mjData may be stepped by as many threads. Not to be
/// called while one of them steps.
SOFTFINGER_MUJOCO_API void softfinger_mujoco_install(softfinger_mujoco* plugin);

/// Does the work of the callback, for programs with a loop of their own: between mj_step1 and
/// mj_step2.
SOFTFINGER_MUJOCO_API void softfinger_mujoco_apply(softfinger_mujoco* plugin,
                                                   const struct mjModel_* model,
                                                   struct mjData_* data);

/// e_n(P) in m as it is set for a listed geom; 0 for a geom that is not listed.
SOFTFINGER_MUJOCO_API double softfinger_mujoco_eccentricity_m(const softfinger_mujoco* plugin,
                                                              int geom, double load_N);

#ifdef __cplusplus
}
#endif

#endif

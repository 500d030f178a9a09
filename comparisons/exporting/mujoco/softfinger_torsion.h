#ifndef SOFTFINGER_TORSION_H
#define SOFTFINGER_TORSION_H

/// Torsional friction that follows the load, for any MuJoCo, whatever the layout of its structs:
/// these functions see numbers and pointers to single numbers. libsoftfinger_mujoco does all of the
/// work in MuJoCo 2.2. With MuJoCo 3 a program's own loop does it:
///
///     mj_step1(m, d);
///     for (int i = 0; i < d->ncon; ++i) {          // the contacts of a soft geom, condim 4 or 6
///       mjContact* c = d->contact + i;
///       if (c->efc_address < 0) continue;
///       int row = c->efc_address + 3;
///       softfinger_torsion_set(finger, NULL, normal_N, c->friction, d->efc_R + row,
///                              d->efc_D + row, d->efc_diagA + row, diagonal);
///       if (d->nisland > 0) {                      // copies in the order of the islands
///         d->iefc_R[d->map_efc2iefc[row]] = d->efc_R[row];
///         d->iefc_D[d->map_efc2iefc[row]] = d->efc_D[row];
///       }
///     }
///     mj_step2(m, d);
///     // normal_N of the next step: d->efc_force[c->efc_address], summed over the pair of geoms
///
/// `diagonal` is the row's element on the diagonal of efc_AR where mj_isDual(m), as with
/// noslip_iterations, else NULL. efc_diagA is called efc_diagApprox in older versions. The cone is
/// elliptic. normal_N is that of the last step, 0 where the pair did not touch: then nothing
/// changes.

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define SOFTFINGER_TORSION_API __attribute__((visibility("default")))
#else
#define SOFTFINGER_TORSION_API
#endif

typedef struct softfinger_torsion softfinger_torsion;

/// Tabulates e_n(P) of `fingertip_layer`. The numbers are those of the model's field
/// "softfinger:GEOM": R' >= R'' > 0 in m, thickness in m, E in Pa, nu, and three more where the
/// finger is curved, its curvatures xx, yy, xy in 1/m. Returns NULL, with one line in `error`, for
/// others.
SOFTFINGER_TORSION_API softfinger_torsion* softfinger_torsion_create(const double* numbers,
                                                                     int count, char* error,
                                                                     int error_size);

SOFTFINGER_TORSION_API void softfinger_torsion_free(softfinger_torsion* finger);

/// e_n(P) in m; load_N >= 0.
SOFTFINGER_TORSION_API double softfinger_torsion_eccentricity_m(const softfinger_torsion* finger,
                                                                double load_N);

/// Sets friction[2] = friction[0] e_n(normal_N) of a contact and what MuJoCo has derived from it in
/// its torsional row. Of two soft fingers the larger e_n counts, as of all of MuJoCo's
/// coefficients.
/// @param other          may be NULL
/// @param friction       mjContact's, 5 numbers
/// @param efc_diagA, efc_AR_diagonal  may be NULL
SOFTFINGER_TORSION_API void softfinger_torsion_set(const softfinger_torsion* finger,
                                                   const softfinger_torsion* other, double normal_N,
                                                   double* friction, double* efc_R, double* efc_D,
                                                   double* efc_diagA, double* efc_AR_diagonal);

#ifdef __cplusplus
}
#endif

#endif

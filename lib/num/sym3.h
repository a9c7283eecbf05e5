/* sym3.h - eigenvalues and vectors of a symmetric 3 x 3 matrix
 *
 * Cyclic Jacobi rotations: accurate to the last bits of the largest eigenvalue, also
 * where eigenvalues coincide.
 */
#ifndef NUM_SYM3_H
#define NUM_SYM3_H

/* m holds xx yy zz xy xz yz.  value[] descends; vector[k] is the unit eigenvector of
 * value[k], with its largest component positive.  vector may be NULL. */
void sym3_eigen(const double m[6], double value[3], double vector[3][3]);

#endif

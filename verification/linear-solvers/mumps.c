/* MUMPS, for one process, as the study of linear solvers calls it: analyse, factor and solve unsymmetric matrices by their entries. */

#include <dmumps_c.h>
#include <stdlib.h>
#include <string.h>

/* Commands and codes of MUMPS. */
enum { START = -1, END = -2, ANALYSE = 1, FACTOR = 2, SOLVE = 3, SELF_COMMUNICATOR = -987654, METIS = 5 };

/* Starts MUMPS and analyses a pattern with the ordering of METIS, or another one where the library has none (Debian's: Scotch); rows and columns are counted from 1 and stay the caller's. NULL if that fails. */
DMUMPS_STRUC_C *mumps_begin(int unknowns, long long entries, int *rows, int *columns) {
    DMUMPS_STRUC_C *mumps = calloc(1, sizeof *mumps);
    if (!mumps) {
        return NULL;
    }
    mumps->job = START;
    mumps->par = 1;
    mumps->sym = 0;
    mumps->comm_fortran = SELF_COMMUNICATOR;
    dmumps_c(mumps);
    for (int stream = 0; stream < 4; stream++) {
        mumps->icntl[stream] = 0; /* no messages */
    }
    mumps->icntl[6] = METIS;
    mumps->icntl[5] = 0; /* no permutation of columns to a large diagonal, which needs values */
    mumps->n = unknowns;
    mumps->nnz = entries;
    mumps->irn = rows;
    mumps->jcn = columns;
    mumps->job = ANALYSE;
    dmumps_c(mumps);
    return mumps;
}

/* Code of the last call: 0, or below 0 for an error. */
int mumps_code(const DMUMPS_STRUC_C *mumps) {
    return mumps->infog[0];
}

/* Memory that factorizations take [MB]. */
int mumps_megabytes(const DMUMPS_STRUC_C *mumps) {
    return mumps->infog[21];
}

/* Operations of the elimination, by the analysis. */
double mumps_operations(const DMUMPS_STRUC_C *mumps) {
    return mumps->rinfog[0];
}

/* Factors values in the order of the entries. */
void mumps_factor(DMUMPS_STRUC_C *mumps, double *values) {
    mumps->a = values;
    mumps->job = FACTOR;
    dmumps_c(mumps);
}

/* Replaces a right-hand side by the solution. */
void mumps_solve(DMUMPS_STRUC_C *mumps, int transposed, double *rhs) {
    mumps->icntl[8] = transposed ? 0 : 1;
    mumps->rhs = rhs;
    mumps->job = SOLVE;
    dmumps_c(mumps);
}

/* Gives everything back. */
void mumps_end(DMUMPS_STRUC_C *mumps) {
    mumps->job = END;
    dmumps_c(mumps);
    free(mumps);
}

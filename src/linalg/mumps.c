/* MUMPS, for one process of MPI or for several, as `mumps.rs` calls it: analyse, factor and solve unsymmetric matrices by their entries. */

#include <dmumps_c.h>
#include <mpi.h>
#include <stdlib.h>

/* Commands and settings of MUMPS. */
enum { START = -1, END = -2, ANALYSE = 1, FACTOR = 2, SOLVE = 3, METIS = 5, BY_EACH_PROCESS = 3 };
/* Codes where it had planned for too little memory, and how often it may plan for more. */
enum { TOO_LITTLE = -9, TOO_LITTLE_OF_NUMBERS = -8, TIMES = 8 };

static void finish(void) {
    int finished;
    MPI_Finalized(&finished);
    if (!finished) {
        MPI_Finalize();
    }
}

/* The communicator of this process alone; starts MPI where nobody has. */
static int alone(void) {
    int started, given;
    MPI_Initialized(&started);
    if (!started) {
        MPI_Init_thread(NULL, NULL, MPI_THREAD_SERIALIZED, &given);
        atexit(finish);
    }
    return (int)MPI_Comm_c2f(MPI_COMM_SELF);
}

/* Starts MUMPS on the processes of a communicator of Fortran, or on this one alone where `communicator` is below zero, and analyses a pattern
 * with the ordering of METIS, or another one where the library has none (Debian's). Each process has some entries, each entry one process;
 * rows and columns are counted from 1 and stay the caller's. NULL if there is no memory. */
DMUMPS_STRUC_C *mumps_begin(int communicator, int unknowns, long long entries, int *rows, int *columns) {
    DMUMPS_STRUC_C *mumps = calloc(1, sizeof *mumps);
    if (!mumps) {
        return NULL;
    }
    mumps->job = START;
    mumps->par = 1;
    mumps->sym = 0;
    mumps->comm_fortran = communicator < 0 ? alone() : communicator;
    dmumps_c(mumps);
    for (int stream = 0; stream < 4; stream++) {
        mumps->icntl[stream] = 0; /* no messages */
    }
    mumps->icntl[6] = METIS;
    mumps->icntl[5] = 0; /* no permutation of columns to a large diagonal, which needs values */
    mumps->icntl[17] = BY_EACH_PROCESS;
    mumps->icntl[23] = 1; /* pivots that vanish are told, not an error */
    mumps->n = unknowns;
    mumps->nnz_loc = entries;
    mumps->irn_loc = rows;
    mumps->jcn_loc = columns;
    mumps->job = ANALYSE;
    dmumps_c(mumps);
    return mumps;
}

/* Code of the last call: 0, or below 0 for an error. */
int mumps_code(const DMUMPS_STRUC_C *mumps) {
    return mumps->infog[0];
}

/* The ordering that it took: 0 AMD, 2 AMF, 3 Scotch, 4 PORD, 5 METIS, 6 QAMD. */
int mumps_ordering(const DMUMPS_STRUC_C *mumps) {
    return mumps->infog[6];
}

/* Memory that factorizations take, of all processes together [MB]. */
int mumps_megabytes(const DMUMPS_STRUC_C *mumps) {
    return mumps->infog[21];
}

/* Operations of the elimination, by the analysis. */
double mumps_operations(const DMUMPS_STRUC_C *mumps) {
    return mumps->rinfog[0];
}

/* Entries of the factors, by the analysis; where they are below zero, MUMPS counts them in millions. */
double mumps_entries(const DMUMPS_STRUC_C *mumps) {
    int entries = mumps->infog[19];
    return entries < 0 ? -1e6 * entries : entries;
}

/* Factors values in the order of the entries. */
void mumps_factor(DMUMPS_STRUC_C *mumps, double *values) {
    mumps->a_loc = values;
    for (int time = 0; time < TIMES; time++) {
        mumps->job = FACTOR;
        dmumps_c(mumps);
        if (mumps->infog[0] != TOO_LITTLE && mumps->infog[0] != TOO_LITTLE_OF_NUMBERS) {
            break;
        }
        mumps->icntl[13] = 2 * mumps->icntl[13] + 20;
    }
}

/* On the first process, an unknown without a pivot in the last factorization, counted from 1; 0 where there is none. */
int mumps_unknown_without_pivot(const DMUMPS_STRUC_C *mumps) {
    return mumps->infog[27] > 0 && mumps->pivnul_list ? mumps->pivnul_list[0] : 0;
}

/* Replaces right-hand sides of the first process, one after the other, by solutions. */
void mumps_solve(DMUMPS_STRUC_C *mumps, int transposed, int count, double *rhs) {
    mumps->icntl[8] = transposed ? 0 : 1;
    mumps->nrhs = count;
    mumps->lrhs = mumps->n;
    mumps->rhs = rhs;
    mumps->job = SOLVE;
    dmumps_c(mumps);
}

/* Gives everything back, unless MPI has ended. */
void mumps_end(DMUMPS_STRUC_C *mumps) {
    int finished;
    MPI_Finalized(&finished);
    if (finished) {
        return;
    }
    mumps->job = END;
    dmumps_c(mumps);
    free(mumps);
}

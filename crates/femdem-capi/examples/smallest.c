/* Two cubes of side 1 m, face on face, 1 mm into each other: p a delta (1/h_A + 1/h_B) = 4000 N, less the rim. */
#include <femdem.h>

#include <math.h>
#include <stdio.h>

int main(void) {
    FemdemShape cube;
    FemdemPose below = {{0, 0, 0}, {1, 0, 0, 0}}, above = {{0, 0, 0.999}, {1, 0, 0, 0}};
    FemdemPair pair;
    if (femdem_shape_named("cube", sqrt(3.0), 0.0, &cube) != FEMDEM_STATUS_OK ||
        femdem_pair_evaluate(1e6, cube, &below, cube, &above, &pair) != FEMDEM_STATUS_OK) {
        fprintf(stderr, "%s\n", femdem_last_error());
        return 1;
    }
    printf("%.1f N on the upper cube\n", pair.on_b.force[2]);
    femdem_shape_free(cube);
    return fabs(pair.on_b.force[2] / 4000.0 - 1.0) < 0.003 ? 0 : 1;
}

/* dda_walk.h -- from cell to cell along a ray. This is the file that you hand in.
 *
 * OpenCL C, one ray at a time; dda.cl says what a walk is. page.md says what to do, and what this file may use. */

/* Sets walk->cell to the first cell that the ray visits. Returns 1; 0 if there is none. */
int dda_first(dda_walk *walk)
{
    walk->cell[0] = walk->cell[1] = walk->cell[2] = 0;
    return 1;
}

/* Sets walk->cell to the next cell. nearest: the distance of the nearest surface so far, along the ray from walk->point. Returns 1; 0 if
 * no further cell can have a nearer one. A cell outside of the grid ends the walk, too.
 *
 * This one visits every cell of the grid. */
int dda_next(dda_walk *walk, float nearest)
{
    for (int k = 0; k < 3; ++k) {
        walk->cell[k] += 1;
        if (walk->cell[k] < walk->cells[k]) return 1;
        walk->cell[k] = 0;
    }
    return 0;
}

#!/bin/sh
# Writes a ball of radius 1 as TetGen does, to NAME.node and NAME.ele: a cube of N^3 cells, six
# tetrahedra each, whose shells become spheres. Usage: ball_of_tets.sh NAME [N]
set -eu
awk -v name="$1" -v n="${2:-6}" 'BEGIN {
    m = n + 1
    printf "%d 3 0 0\n", m * m * m >(name ".node")
    for (i = 0; i < m * m * m; i++) {
        x = 2 * (i % m) / n - 1; y = 2 * (int(i / m) % m) / n - 1; z = 2 * int(i / (m * m)) / n - 1
        a = x < 0 ? -x : x; b = y < 0 ? -y : y; c = z < 0 ? -z : z
        shell = a > b ? (a > c ? a : c) : (b > c ? b : c)
        length2 = sqrt(x * x + y * y + z * z)
        scale = length2 > 0 ? shell / length2 : 0
        printf "%d %.6f %.6f %.6f\n", i + 1, scale * x, scale * y, scale * z >(name ".node")
    }
    split("0 1 3 7 0 1 5 7 0 2 3 7 0 2 6 7 0 4 5 7 0 4 6 7", kuhn, " ")
    printf "%d 4 0\n", 6 * n * n * n >(name ".ele")
    for (i = 0; i < m * m * m; i++) {
        if (i % m == n || int(i / m) % m == n || int(i / (m * m)) == n) continue
        for (t = 0; t < 6; t++) {
            printf "%d", ++count >(name ".ele")
            for (k = 1; k <= 4; k++) {
                c = kuhn[4 * t + k]
                # a path that leads outward in every octant: corners are mirrored with the cell
                u = (i % m < n / 2) ? 1 - c % 2 : c % 2
                v = (int(i / m) % m < n / 2) ? 1 - int(c / 2) % 2 : int(c / 2) % 2
                w = (int(i / (m * m)) < n / 2) ? 1 - int(c / 4) : int(c / 4)
                printf " %d", i + 1 + u + m * v + m * m * w >(name ".ele")
            }
            printf "\n" >(name ".ele")
        }
    }
}'

# Rows of n, columns of K h^2/m: how many times as fast a step of cholesky is, and after how many steps it has caught up with cg.
BEGIN { FS = "," }
$3 == tolerance && $4 == "cg" { ms = $6; iterations = $8 }
$3 == tolerance && $4 == "cholesky" {
    if (!($1 in seen)) { seen[$1] = 1; size[++sizes] = $1 }
    if (!($2 in known)) { known[$2] = 1; number[++numbers] = $2 }
    solve = int(iterations / $7 + 0.5)
    cell[$1, $2] = sprintf("%s%.3g (%d) %s", solve < 3000 ? "" : "> ", ms / $6, solve, $12 == "inf" ? "never" : $12)
}
END {
    printf "| n; K h² / m: |"; for (k = 1; k <= numbers; k++) printf " %s |", number[k]; printf "\n|---|"
    for (k = 1; k <= numbers; k++) printf "---|"; printf "\n"
    for (i = 1; i <= sizes; i++) {
        printf "| %d |", size[i]; for (k = 1; k <= numbers; k++) printf " %s |", cell[size[i], number[k]]; printf "\n"
    }
}

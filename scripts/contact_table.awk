# Prints the table of runs of docs/results/contact.md from bench/contact.csv.
NR == 1 {
    print "| run | vertices | steps | intersections | elements in contact | outer iterations | largest residual | time of contact over the rest | moved in the last half, mm |"
    print "|---|---|---|---|---|---|---|---|---|"
    next
}
{ printf "| %s | %d | %d | %d | %d | %.1f | %s | %.1f | %s |\n", $1, $2, $3, $5, $6, $7, $9, $10 / $11, $12 == "" ? "-" : $12 }

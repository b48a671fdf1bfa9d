# Writes the table between its marks in docs/results/contact.md (second file) from bench/contact.csv (first).
FNR == NR && FNR > 1 {
    row[++rows] = sprintf("| %s | %d | %d | %d | %d | %.1f | %s | %.0f / %.0f | %s |", $1, $2, $3, $5, $6, $7, $9, $10, $11, $12 == "" ? "-" : $12)
}
FNR == NR { next }
/<!-- table -->/ {
    print
    print "| run | vertices | steps | intersections | elements in contact | outer iterations | largest residual | ms of contact / rest | moved in the last half, mm |"
    print "|---|---|---|---|---|---|---|---|---|"
    for (k = 1; k <= rows; k++) print row[k]
    print "<!-- end -->"
    old = 1
    next
}
old && /<!-- end -->/ { old = 0; next }
old && /^(\||$)/ { next }
{ print }

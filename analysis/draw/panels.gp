# panels.gp - draws title, labels and objects given so far, with the legend at legend_x, legend_y (its
# first line); panels follow, over it.
line = legend_y
if (legend_head ne '') {
    legend_head = wrap(legend_head, letters(page_width - legend_x - margin, 10))
    set label legend_head at screen X(legend_x), Y(line) left @small front
    line = line + 6 + 16*lines(legend_head)
}
do for [k=1:legends] {
    eval box(legend_x, line, legend_colour[k])
    set label legend_text[k] at screen X(legend_x + 22), Y(line) left font ',12' front
    line = line + legend_step
}
do for [k=1:notes] {
    set label note[k] at screen X(legend_x), Y(line + 2) left @small front
    line = line + 17
}
eval panel(0, 0, page_width, page_height)
unset border; unset tics
plot [0:1][0:1] 2 notitle # nothing of it is seen but what was set before
unset label; unset object; unset arrow
set border 31 lw 0.8 lc '#404040'
set xtics nomirror out scale 0.6 textcolor '#202020'
set ytics nomirror out scale 0.6 textcolor '#202020'

# panels.gp - draws title, labels and objects given so far, with the legend at legend_x, legend_y (its
# first line) or below the panels; panels follow, over it.
if (legend_below) { legend_x = margin; legend_y = legend_floor + 6 }
if (legend_head ne '') { set label legend_head at screen X(legend_x), Y(legend_y) left @small front }
do for [k=1:legends] {
    eval mark(k, legend_x + entry_x[k], legend_y + entry_y[k])
    set label legend_text[k] at screen X(legend_x + entry_x[k] + legend_indent), Y(legend_y + entry_y[k]) left font ',12' front
    if (legend_about[k] ne '') { set label legend_about[k] at screen X(legend_x + entry_x[k] + legend_indent), Y(legend_y + entry_y[k] + 3) left font ',9' front }
}
line = legend_y + notes_y + 2
do for [k=1:notes] {
    set label note[k] at screen X(legend_x), Y(line) left @small front
    line = line + 17*lines(note[k])
}
eval panel(0, 0, page_width, page_height)
unset border; unset tics
plot [0:1][0:1] 2 notitle # nothing of it is seen but what was set before
unset label; unset object; unset arrow
set border 31 lw 0.8 lc '#404040'
set xtics nomirror out scale 0.6 textcolor '#202020'
set ytics nomirror out scale 0.6 textcolor '#202020'

# panels.gp - draws title, labels and objects given so far, with the legend at legend_x, legend_y (its
# first line) or below the panels; panels follow, over it.
if (legend_below) { legend_x = margin; legend_y = legend_floor + 6 + table_top }
if (legend_head ne '') { set label legend_head at screen X(legend_x), Y(legend_y) left @small front }
do for [k=1:legends] {
    eval mark(k, legend_x + entry_x[k], legend_y + entry_y[k])
    set label legend_text[k] at screen X(legend_x + entry_x[k] + legend_indent), Y(legend_y + entry_y[k]) left font ',12' front
    if (legend_about[k] ne '') { set label legend_about[k] at screen X(legend_x + entry_x[k] + legend_indent), Y(legend_y + entry_y[k] + 3) left font ',9' front }
}
# Entries of the legend as rows of a table.
f_wide = table_columns > 0 ? (page_width - 2*margin - table_names)/table_columns : 0
do for [c=1:table_columns] {
    f_left = margin + table_names + (c - 1)*f_wide
    set label wrap(table_head[c], f_wide/8) at screen X(f_left), Y(legend_y - 22 - 8*(lines(wrap(table_head[c], f_wide/8)) - 1)) left @small front
    do for [k=1:legends] {
        f_cell = (k - 1)*table_columns + c
        set label cell_text[f_cell] at screen X(f_left), Y(legend_y + entry_y[k]) left @small front
        set label cell_more[f_cell] at screen X(f_left), Y(legend_y + entry_y[k] + 15) left @small front
    }
}
line = legend_y + notes_y + 2
do for [k=1:notes] {
    set label note[k] at screen X(legend_x), Y(line) left @small front
    line = line + 17*lines(note[k])
}
eval panel(0, 0, page_width, page_height)
unset border; unset tics
# Nothing of the plot is seen but what was set before; frames of a picture that moves have that each.
if (frames < 2) {
    plot [0:1][0:1] 2 notitle
    unset label; unset object; unset arrow
}
set border 31 lw 0.8 lc '#404040'
set xtics nomirror out scale 0.6 textcolor '#202020'
set ytics nomirror out scale 0.6 textcolor '#202020'

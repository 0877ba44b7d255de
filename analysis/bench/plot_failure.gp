# plot_failure.gp - a map for each method: the verdicts with a table of their shares under the maps, or the
# energy that was created (energy), whose decimal logarithms go from lowest to highest.
left = 122
head = 24
gap = 46
row_height = 24 # of the table under the maps, as of legends
names_width = 264
column_width = asked_width > 0 ? at_most(152, (asked_width - left - 24 - names_width)/panels) : 152
columns = panels < 3 ? panels : 3
width = wide(300, columns, left + (columns - 1)*gap + 24)
height = int(0.8*width)
rows = (panels + columns - 1)/columns
maps_width = columns*(width + gap) - gap
panel_left(p) = left + (p - 1) % columns*(width + gap)
panel_top(p) = top + (p - 1)/columns*(height + head + 14) + head
column_left(p) = left + names_width + (p - 1)*column_width

page_width = left + 24 + (maps_width > names_width + panels*column_width ? maps_width : names_width + panels*column_width)
top = title_height(0)
maps_bottom = panel_top(1) + rows*(height + head + 14) - head
table_top = maps_bottom + 82
page_height = table_top + (energy ? 116 : row_height*(legends + (theory ? 4 : 3)) + 14)
load 'page.gp'
do for [p=1:panels] {
    set label name[p] at screen X(panel_left(p) + 0.5*width), Y(panel_top(p) - 11) center font ',12' front
    set label wrap(name[p], column_width/8) at screen X(column_left(p)), Y(table_top + (energy ? 62 : 0) - 8*(lines(wrap(name[p], column_width/8)) - 1)) \
        left @small front
    if (energy) {
        set label largest[p] at screen X(column_left(p)), Y(table_top + 84) left @small front
    } else {
        do for [k=1:legends] {
            set label share[(k-1)*panels + p] at screen X(column_left(p)), Y(table_top + row_height*k) left @small front
        }
        do for [k=0:1] {
            set label reason[2*(p-1) + k + 1] at screen X(column_left(p)), Y(table_top + row_height*(legends + 1) + 15*k) \
                left @tiny front
        }
    }
}
set label axis_label('x', maps_width) at screen X(left + 0.5*maps_width), Y(maps_bottom + 40) center @small front
eval y_label(axis_label('y', maps_bottom - top), 18, 0.5*(top + maps_bottom))
theory_left = left
theory_top = table_top + row_height*(legends + 2) + 14
legend_x = left
legend_y = table_top + row_height
legend_step = row_height
if (energy) {
    eval box(left + 450, table_top + 8, 0xffffff)
    set label 'failed' at screen X(left + 472), Y(table_top + 8) left font ',12' front
    set label 'largest share of a map:' at screen X(left), Y(table_top + 62) left @small front
    theory_left = left + 540
    theory_top = table_top + 8
} else {
    set label 'reasons of failures' at screen X(left + 22), Y(table_top + row_height*(legends + 1)) left @small front
}
if (theory) {
    set arrow from screen X(theory_left),Y(theory_top) to screen X(theory_left + 15),Y(theory_top) nohead lw 1.6 lc rgb 'black' front
    set label theory_text at screen X(theory_left + 22), Y(theory_top) left font ',12' front
}
load 'panels.gp'

eval cells_of('x')
eval cells_of('y')
if (energy) {
    eval palette
    set cbrange [lowest:highest]
    eval colour_bar(left, table_top, 420, 14)
    set cbtics ('1e-16' -16, '1e-12' -12, '1e-08' -8, '0.0001' -4, '1' 0) nomirror out scale 0.5
}
cell_colour(code) = verdict_colour[code+1]
# The line of theory: white under black.
theory_lines = "$theory using 1:2 with lines lc rgb 'white' lw 3.6 notitle, $theory using 1:2 with lines lc rgb 'black' lw 1.6 notitle"
do for [p=1:panels] {
    eval panel(panel_left(p), panel_top(p), width, height)
    eval axis_tics('x', width/60, p + columns > panels)
    eval axis_tics('y', height/34, (p - 1) % columns == 0)
    if (energy) { plot @cells @as_numbers notitle, @theory_lines } else { plot @cells @as_colours notitle, @theory_lines }
    unset colorbox # one for all
}

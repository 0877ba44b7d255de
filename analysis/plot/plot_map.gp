# plot_map.gp - a map in each panel, over the axes x and y: what became of every case, or the numbers of
# one answer (measured), lowest ... highest. Over a panel stands its title and at the right its share. A table of
# panels (so many across, 0: none) has titles over its columns and beside its rows.
gap = asked_width > 0 ? 16 : 28
head = panels > 1 ? 22 : 0
row_head = table ? 44 : 0
column_head = table ? 40 : 0

# Words beside the panels take more room than numbers.
longest = 6
if (y_scale eq 'list') { do for [k=1:y_words] { longest = strlen(y_word[k]) > longest ? strlen(y_word[k]) : longest } }
left = 118 + 9*((longest < 24 ? longest : 24) - 6)

# The page is a little wider than it is high, and full where it can be.
columns = panels == 3 ? 3 : int(ceil(sqrt(1.2*panels)))
if (columns > 2 && panels % columns && panels % (columns - 1) == 0) { columns = columns - 1 }
if (asked_width > 0) { columns = int(at_most(columns, at_least(1, (asked_width - left - legend_room + gap)/(130 + gap)))) }
if (table) { columns = table }
if (columns > panels) { columns = panels }
rows = (panels + columns - 1) / columns
own_width = panels == 1 ? 560 : panels <= 4 ? 336 : panels <= 16 ? 235 : 170
own_height = panels == 1 ? 500 : panels <= 4 ? 300 : panels <= 16 ? 210 : 150
width = wide(own_width, columns, left + (columns - 1)*gap + row_head + legend_room)
panel_left(p) = left + (p - 1) % columns*(width + gap)
panel_top(p) = top + column_head + (p - 1)/columns*(height + head + 12) + head
right = left + columns*(width + gap) - gap

page_width = right + row_head + legend_room
top = title_height(0)
height = high(1.0*own_height*width/own_width, rows, top + column_head + rows*head + (rows - 1)*12 + 84)
bottom = panel_top(panels) + height
page_height = bottom + 84
load 'page.gp'

eval x_label(0.5*(left + right), bottom + 46)
# Long names may go on beside the labels under the map, but not into the title.
eval y_label(axis_label('y', bottom - top + 28), 22, 0.5*(top + bottom) + 14)

# The longest names for which the titles of all panels have room: letters take 7 px on average.
fits_long = 1
fits_short = 1
do for [p=1:panels] {
    room = width + 4 - 7*strlen(share[p])
    fits_long = fits_long && 7*strlen(title_long[p]) < room
    fits_short = fits_short && 7*strlen(title_short[p]) < room
}
do for [p=1:panels] {
    title_here = table ? '' : fits_long ? title_long[p] : fits_short ? title_short[p] : title_bare[p]
    set label title_here at screen X(panel_left(p)), Y(panel_top(p) - 11) left @tiny front
    set label panels > 1 ? share[p] : '' at screen X(panel_left(p) + width), Y(panel_top(p) - 11) right @tiny front
}
# Of a table the name stands once where it has no room beside each value.
fits_columns = 1
fits_rows = 1
do for [c=1:table] { fits_columns = fits_columns && 7*strlen(column_long[c]) < width + gap }
do for [r=1:(table ? rows : 0)] { fits_rows = fits_rows && 7*strlen(row_long[r]) < height + head }
do for [c=1:table] {
    set label fits_columns ? column_long[c] : column_bare[c] at screen X(panel_left(c) + 0.5*width), Y(panel_top(c) - 30) \
        center @tiny front
}
do for [r=1:(table ? rows : 0)] {
    set label fits_rows ? row_long[r] : row_bare[r] at screen X(right + 14), Y(panel_top(r*columns) + 0.5*height) \
        center rotate by -90 @tiny front
}
if (table && !fits_columns) { set label column_name at screen X(0.5*(left + right)), Y(panel_top(1) - 48) center @tiny front }
if (table && !fits_rows) { set label row_name at screen X(right + 32), Y(0.5*(panel_top(1) + bottom)) center rotate by -90 @tiny front }
legend_x = right + row_head + 20
legend_y = panel_top(1) + 10
load 'panels.gp'

eval cells_of('x')
eval cells_of('y')
if (measured) {
    if (!(highest > lowest)) { lowest = lowest - 0.5; highest = lowest + 1 } # a range of nothing cannot be drawn
    eval palette
    set cbrange [lowest:highest]
    set cbtics round_step(lowest, highest, 6) nomirror out scale 0
    set cblabel with_unit(measure, measure_unit) offset 0.5,0
    eval legend_bar(0)
    set object 1 rectangle from graph 0,0 to graph 1,1 behind fillcolor rgb no_number fillstyle solid noborder
}
over = allowed ? over_map : ''
cell_colour(code) = kind_colour[code+1]
if (cross) {
    set label 1 '' at cross_x,cross_y point pt 1 ps 1.6 lw 4.5 lc rgb 'white' front
    set label 2 '' at cross_x,cross_y point pt 1 ps 1.4 lw 2 lc rgb 'black' front
}
do for [p=1:panels] {
    eval panel(panel_left(p), panel_top(p), width, height)
    eval axis_tics('x', width/65, p + columns > panels)
    eval axis_tics('y', height/45, (p - 1) % columns == 0)
    if (measured) { plot @cells @as_numbers notitle @over } else { plot @cells @as_colours notitle @over }
    unset colorbox # one for all
}

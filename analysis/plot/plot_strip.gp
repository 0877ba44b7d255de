# plot_strip.gp - stick figures from left to right and row by row, at even intervals of time. Both directions
# have the same scale. In the plane of $ground, $segments and $points the figures stand `spacing` apart.
per_row = asked_width > 0 && asked_width < 760 ? 5 : 7
side = 24
times_height = 30

page_width = wide(1120, 1, 0)
top = title_height(0)
# Contacts, the body, perhaps the second case, and last the bar that is the scale: in as many lines as they take.
group_colour(k) = k < contacts ? hue[k%|hue|+1] : 0x303030
entries = contacts + 1 + (cases > 1) + 1
array entry_name[entries]; array entry_left[entries]; array entry_line[entries]
do for [k=1:entries-1] { entry_name[k] = k <= contacts ? contact_name[k] : k == contacts + 1 ? 'body' : 'the second case' }
bar = round_step(0, spacing, 3)
entry_name[entries] = sprintf('%g m', bar).(travels ? '; each figure is centred: it travels' : '')
columns = count < per_row ? count : per_row
rows = (count + per_row - 1)/per_row
# A lonely figure is not to fill a wall.
scale = (page_width - 2*side)/(columns*spacing)
scale = scale < 320/(high - low) ? scale : 320/(high - low)
height = scale*(high - low)
left = side
line = 0
do for [k=1:entries] {
    mark_width = (k < entries ? 14 : bar*scale) + 8
    if (left > side && left + mark_width + 8*strlen(entry_name[k]) > page_width - margin) { left = side; line = line + 1 }
    entry_left[k] = left
    entry_line[k] = 10 + 22*line
    left = left + mark_width + 28 + 8*strlen(entry_name[k])
}
head_height = 26 + entry_line[entries]
panel_top(row) = top + head_height + (row - 1)*(height + times_height)
page_height = int(panel_top(rows + 1) + 8)
load 'page.gp'

do for [k=1:entries] {
    line = top + entry_line[k]
    if (k < entries) { eval box(entry_left[k], line, k <= contacts + 1 ? group_colour(k - 1) : 0xb8b8b8) }
    set label entry_name[k] at screen X(entry_left[k] + (k < entries ? 14 : bar*scale) + 8), Y(line) left font ',12' front
}
set arrow from screen X(entry_left[entries]),Y(line) to screen X(entry_left[entries] + bar*scale),Y(line) \
    heads size screen 0.004,90 lw 1.4 lc rgb '#404040'
do for [i=1:count] {
    set label sprintf('%.3g s', time[i]) at screen X(side + scale*spacing*((i - 1) % per_row + 0.5)), \
        Y(panel_top((i - 1)/per_row + 2) - times_height + 10) center font ',12' front
}
load 'panels.gp'

unset border
unset xtics
unset ytics
set yrange [low:high]
do for [row=1:rows] {
    first = (row - 1)*per_row
    last = count < row*per_row ? count : row*per_row
    eval panel(side, panel_top(row), scale*spacing*(last - first), height)
    set xrange [first*spacing:last*spacing]
    plot $ground using 1:2 with lines lw 2 lc rgb '#a0a0a0' notitle, \
        $other using 1:2 with lines lw 2.6 lc rgb '#b8b8b8' notitle, \
        for [k=contacts:0:-1] $segments using 1:($3 == k ? $2 : NaN) with lines lw 2.6 lc rgb group_colour(k) notitle, \
        for [k=contacts:0:-1] $points using 1:($3 == k ? $2 : NaN) with points pt 7 ps (k < contacts ? 0.75 : 0.9) \
            lc rgb group_colour(k) notitle
}

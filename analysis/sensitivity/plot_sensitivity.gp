# plot_sensitivity.gp - a panel for each table. Indices: a row for each factor, the most important first, with
# first and total index one above the other. Morris: mean magnitude of the effects mu* against their standard
# deviation sigma, factors by number.
letter = 8
longest = 0
do for [i=1:factors] { longest = strlen(factor[i]) > longest ? strlen(factor[i]) : longest }
columns = morris ? 2 : 3
columns = panels < columns ? panels : columns
row_height = 30
gap = morris ? 64 : 30
head = 30
left = morris ? 84 : letter*longest + 34
beside = morris ? letter*longest + 40 : legend_room
if (asked_width > 0) { columns = int(at_least(1, at_most(columns, (asked_width - left - beside)/(120 + gap)))) }
width = wide(morris ? 340 : panels == 1 ? 460 : 260, columns, left + columns*gap + beside - (morris ? 0 : 20))
height = morris ? width : row_height*factors + 10
right = left + columns*(width + gap)
panel_left(t) = left + (t - 1) % columns*(width + gap)
panel_top(t) = top + head + (t - 1)/columns*(height + head + 30)

page_width = right + (morris ? beside : beside - 20)
top = title_height(0)
page_height = panel_top(panels) + height + 62
list_bottom = panel_top(1) + 20 + 17*factors
if (morris && list_bottom > page_height) { page_height = list_bottom }
load 'page.gp'
do for [t=1:panels] {
    set label end_of(panel_title[t], (width + gap)/letter) at screen X(panel_left(t)), Y(panel_top(t) - 14) left @small front
}
do for [i=1:factors] {
    if (morris) {
        set label sprintf('%d  %s', i, factor[i]) at screen X(right), Y(panel_top(1) + 10 + 17*(i - 1)) left @small front
    } else {
        do for [t=1:panels:columns] {
            set label factor[i] at screen X(left - 10), Y(panel_top(t) + 5 + row_height*(i - 0.5)) right @small front
        }
    }
}
legend_x = right
legend_y = panel_top(1) + 10
legend_step = 22
load 'panels.gp'

eval grid
set xtics @tiny
set ytics @tiny
if (!morris) {
    # Two series stand above and below the middle of a factor's row.
    place(k) = legends > 1 ? (k == 1 ? -0.16 : 0.16) : 0
    set arrow 1 from 0, graph 0 to 0, graph 1 nohead lc rgb grey lw 1 back
    do for [t=1:panels] {
        eval panel(panel_left(t), panel_top(t), width, height)
        eval linear_tics('x', low, high, width/52, 1)
        set yrange [factors - 0.5 + 5.0/row_height:-0.5 - 5.0/row_height]
        set ytics 1 format '' scale 0
        x_title = t + columns > panels ? 'share of the variance' : ''
        set xlabel x_title @tiny
        plot for [k=1:legends] sprintf('$series%d_%d', k, t) using 1:($0 + place(k)):2:3 with xerrorbars \
            lc rgb hue[k] lw 1.6 pt (k == 1 ? 7 : 5) ps 0.9 notitle
    }
}

# ---- Morris: beside the points the numbers of the factors, the most important first; those at the very same
# point share one, and in a crowd the last go without. Places are px from the panel's lower left corner. ----
array beside_x[6] = [11, 11, -11, -11, 0, 0]
array beside_y[6] = [9, -9, 9, -9, 14, -14]
array number[factors]
array number_x[factors]
array number_y[factors]
point_x(t, i) = width*mu_star[(t-1)*factors + i]/high
point_y(t, i) = height*sigma[(t-1)*factors + i]/high_sigma
same(t, i, j) = point_x(t, i) == point_x(t, j) && point_y(t, i) == point_y(t, j)
# Are the numbers 1 ... i - 1 far enough from a place? Two digits take 17 x 13 px.
covers(j, x, y) = number[j] ne '' && abs(number_x[j] - x) < 17 && abs(number_y[j] - y) < 13
is_free(i, x, y) = i < 2 || 0 == sum [j=1:i-1] covers(j, x, y)
# The first free place beside point i, 0: there is none.
free_place(t, i, k) = k > 6 ? 0 : is_free(i, point_x(t, i) + beside_x[k], point_y(t, i) + beside_y[k]) ? k : free_place(t, i, k + 1)
do for [t=1:(morris ? panels : 0)] {
    do for [i=1:factors] {
        number[i] = same(t, i, i) && (i < 2 || 0 == sum [j=1:i-1] same(t, i, j)) ? sprintf('%d', i) : ''
        k = number[i] eq '' ? 0 : free_place(t, i, 1)
        do for [j=i+1:(k > 0 ? factors : 0)] { if (same(t, i, j)) { number[i] = number[i].','.j } }
        if (k < 1) { number[i] = ''; continue }
        number_x[i] = point_x(t, i) + beside_x[k]
        number_y[i] = point_y(t, i) + beside_y[k]
        set label number[i] at (number_x[i] - 4)*high/width, number_y[i]*high_sigma/height left @tiny front
    }
    eval panel(panel_left(t), panel_top(t), width, height)
    eval linear_tics('x', 0, high, 6, 1)
    eval linear_tics('y', 0, high_sigma, 6, 1)
    x_title = t + columns > panels ? 'mu*, mean magnitude of the effects' : ''
    y_title = (t - 1) % columns == 0 ? 'sigma, standard deviation of the effects' : ''
    set xlabel x_title @tiny
    set ylabel y_title @tiny
    plot x with lines lc rgb grey dt 2 notitle, \
        '$effects'.t using 1:4:2:3:5:6 with xyerrorbars lc rgb '#9ecae1' lw 1 pt 0 notitle, \
        '$effects'.t using 1:4 with points pt 7 ps 0.8 lc rgb hue[1] notitle
    unset label
}

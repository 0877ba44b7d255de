# plot_model.gp - the robot in one posture: $segments its stick figure, the ground z = -fall x or $ground, $zeros where angles are 0,
# $arrows (x, y, dx, dy, ink, whether it has a head) and labels of coordinates, actuators and contacts. Both
# directions have the same scale. The words stand beside the figure, under it where the page is narrow.
array ink[3] = [shade(0x0072b2), shade(0xd55e00), shade(0x009e73)]
page_width = asked_width > 0 ? at_least(420, asked_width) : 1060
words_below = page_width < 800
words_left = words_below ? margin : page_width - 460
words_width = page_width - words_left - margin
beside(i) = wrap(word_text[i], letters(words_width - 24, 10.5))
words_height = 0
do for [i=1:words_shown] { words_height = words_height + 9 + 16*lines(beside(i)) }
words_height = words_height + (words_below ? 120 : 170)
top = title_height(0)
side = words_below ? page_width - 2*margin : words_left - 2*margin
room = 0.28*size
height = side*(high_y - low_y + 2*room)/(high_x - low_x + 2*room)
height = height < 300 ? 300 : height > 620 ? 620 : height
height = asked_height > 0 ? at_least(200, asked_height - top - 20 - (words_below ? words_height : 0)) : height
page_height = int(top + 20 + (words_below ? height + words_height : height > words_height ? height : words_height))
load 'page.gp'

line = words_below ? top + height + 30 : top + 18
do for [i=1:words_shown] {
    set object rectangle from screen X(words_left), Y(line + 5) to screen X(words_left + 10), Y(line - 5) \
        fillcolor rgb ink[word_ink[i]+1] fillstyle solid border lc '#606060' lw 0.5 front
    set label beside(i) at screen X(words_left + 20), Y(line) left font ',11' front
    line = line + 9 + 16*lines(beside(i))
}
# Which way is positive.
line = line + 58
set arrow from screen X(words_left + 10), Y(line) to screen X(words_left + 60), Y(line) head filled size screen 0.010,20 lw 1.6 lc rgb '#303030'
set arrow from screen X(words_left + 10), Y(line) to screen X(words_left + 10), Y(line - 50) head filled size screen 0.010,20 lw 1.6 lc rgb '#303030'
set label 'x, forward' at screen X(words_left + 66), Y(line) left font ',11' front
set label 'z, up' at screen X(words_left + 16), Y(line - 52) left font ',11' front
set label "angles and torques: counter-clockwise\ndashed: where an angle is 0" \
    at screen X(words_left + (words_below ? 150 : 0)), Y(line + (words_below ? -32 : 24)) left font ',11' front
load 'panels.gp'

unset border
unset xtics
unset ytics
eval panel(margin, top + 6, side, height)
scale = at_most(side/(high_x - low_x + 2*room), height/(high_y - low_y + 2*room))
middle_x = 0.5*(low_x + high_x)
middle_y = 0.5*(low_y + high_y)
set xrange [middle_x - 0.5*side/scale:middle_x + 0.5*side/scale]
set yrange [middle_y - 0.5*height/scale:middle_y + 0.5*height/scale]
# Labels stand where they are wanted, or as near to it as they cover neither each other nor lines and arrows; those
# that end far away have a line to what they name. Many stand in two columns beside the figure, coordinates on the left,
# parted up and down, each with its line. Places in px from the middle of the panel.
if (has_place) {
    labels = labels + 1
    label_text[labels] = '(x, z)'; label_x[labels] = place_x + 0.07*size; label_y[labels] = place_y + 0.03*size; label_ink[labels] = 0
    of_x[labels] = place_x; of_y[labels] = place_y
}
array at_x[40]; array at_y[40]; array half_width[40]; array placed[40]
half_height = 9
crowded = labels > 9
column = 0.5*scale*(high_x - low_x) + 110
do for [i=1:labels] {
    placed[i] = 0
    at_x[i] = scale*(label_x[i] - middle_x)
    at_y[i] = scale*((crowded ? of_y[i] : label_y[i]) - middle_y)
    half_width[i] = 4.2*strlen(label_text[i]) + 4
    if (crowded) { at_x[i] = (label_ink[i] == 0 ? -1 : 1)*at_most(column + half_width[i], 0.5*side - half_width[i]) }
}
# What is not to be covered: places on lines, 10 px apart, and the heads of arrows.
array taken_x[2000]; array taken_y[2000]
taken = 0
take(x, y) = taken < 2000 ? (taken = taken + 1, taken_x[taken] = scale*(x - middle_x), taken_y[taken] = scale*(y - middle_y), 0) : 0
take_line(x, y, dx, dy) = (f_n = int(1 + scale*sqrt(dx*dx + dy*dy)/10), f_n < 200 ? \
    sum [f_i=0:f_n] take(x + dx*f_i/f_n, y + dy*f_i/f_n) : 0)
number(line, k) = real(word(line, k))
do for [i=1:(crowded ? 0 : |$segments| - 1)] {
    if (words($segments[i]) == 2 && words($segments[i+1]) == 2) {
        dummy = take_line(number($segments[i], 1), number($segments[i], 2), number($segments[i+1], 1) - number($segments[i], 1), \
            number($segments[i+1], 2) - number($segments[i], 2))
    }
}
do for [i=1:(crowded ? 0 : |$arrows|)] {
    dummy = take_line(number($arrows[i], 1), number($arrows[i], 2), number($arrows[i], 3), number($arrows[i], 4))
}
if (has_place) { do for [i=-1:1] { dummy = take(place_x + 9*i/scale, place_y + 9*(1 - abs(i))/scale) } }
covers(x, y, i, k) = abs(taken_x[k] - x) < half_width[i] + 3 && abs(taken_y[k] - y) < half_height + 4
hides(x, y, i, j) = abs(at_x[j] - x) < half_width[i] + half_width[j] + 2 && abs(at_y[j] - y) < 2*half_height + 2
outside(x, y, i) = abs(x) > 0.5*side - half_width[i] || abs(y) > 0.5*height - half_height
cost(x, y, i) = 1000*outside(x, y, i) + sum [f_j=1:labels] (placed[f_j] ? 400*hides(x, y, i, f_j) : 0) \
    + (taken > 0 ? sum [f_k=1:taken] 40*covers(x, y, i, f_k) : 0)
# Contacts first, which have the least room.
do for [which=2:0:-1] {
    do for [i=1:(crowded ? 0 : labels)] {
        if (label_ink[i] == which) {
            wanted_x = at_x[i]; wanted_y = at_y[i]
            least = cost(wanted_x, wanted_y, i)
            do for [k=0:83] {
                away = 13*(1 + k/12)
                x_try = wanted_x + away*cos(pi*(k % 12)/6); y_try = wanted_y + away*sin(pi*(k % 12)/6)
                now = away < least ? away + cost(x_try, y_try, i) : least
                if (now < least) { least = now; at_x[i] = x_try; at_y[i] = y_try }
            }
            placed[i] = 1
        }
    }
}
over_x(i, j) = half_width[i] + half_width[j] - abs(at_x[i] - at_x[j])
over_y(i, j) = 2*half_height - abs(at_y[i] - at_y[j])
do for [round=1:(crowded ? 80 : 0)] {
    do for [i=2:labels] {
        do for [j=1:i-1] {
            if (over_x(i, j) > 0 && over_y(i, j) > 0) {
                push = (0.25 + 0.5*over_y(i, j))*(at_y[i] < at_y[j] ? -1 : 1)
                at_y[i] = at_y[i] + push; at_y[j] = at_y[j] - push
            }
        }
    }
}
# From the nearest place of a label's edge to what it names.
edge(at, of, half) = at + (of > at + half ? half : of < at - half ? -half : of - at)
set style textbox opaque noborder margins 0.3,0.1
do for [i=1:labels] {
    x_at = middle_x + at_x[i]/scale
    y_at = middle_y + at_y[i]/scale
    edge_x = edge(at_x[i], scale*(of_x[i] - middle_x), half_width[i])
    edge_y = crowded ? at_y[i] : edge(at_y[i], scale*(of_y[i] - middle_y), half_height)
    if (crowded || sqrt((edge_x - scale*(of_x[i] - middle_x))**2 + (edge_y - scale*(of_y[i] - middle_y))**2) > 34) {
        set arrow from middle_x + edge_x/scale, middle_y + edge_y/scale to of_x[i], of_y[i] nohead lw 0.7 \
            lc rgb ink[label_ink[i]+1] front
    }
    set label label_text[i] at x_at, y_at center font ',13' textcolor rgb ink[label_ink[i]+1] boxed front
}
bottom = middle_y - 0.5*height/scale
ground(z) = z > bottom ? z : bottom
plot for [k=uneven:0] '+' using 1:(ground(-fall*$1)) with filledcurves y1=bottom fc rgb '#f0f0f0' notitle, \
    for [k=uneven:0] '+' using 1:(-fall*$1) with lines lw 2 lc rgb '#a0a0a0' notitle, \
    for [k=1:uneven] '$ground' using 1:(ground($2)) with filledcurves y1=bottom fc rgb '#f0f0f0' notitle, \
    for [k=1:uneven] '$ground' using 1:2 with lines lw 2 lc rgb '#a0a0a0' notitle, \
    $segments using 1:2 with lines lw 3.4 lc rgb '#303030' notitle, \
    $zeros using 1:2 with lines dt 2 lw 1.2 lc rgb '#606060' notitle, \
    $segments using 1:2 with points pt 7 ps 0.7 lc rgb '#303030' notitle, \
    for [k=0:2] $arrows using 1:($5 == k && $6 == 0 ? $2 : NaN):3:4 with vectors nohead lw 2 lc rgb ink[k+1] notitle, \
    for [k=0:2] $arrows using 1:($5 == k && $6 == 1 ? $2 : NaN):3:4 with vectors head filled size screen 0.011,22 fixed \
        lw 2 lc rgb ink[k+1] notitle, \
    '+' using (has_place ? place_x : NaN):(place_y) every ::0::0 with points pt 6 ps 2 lw 2 lc rgb ink[1] notitle

# plot_model.gp - the robot in one posture: $segments its stick figure, the ground z = -fall x, $zeros where angles are 0,
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
legend_x = 0
legend_y = 0
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
# Labels that would cover each other part, up and down or to the sides, whichever is less. Many stand in two columns
# beside the figure, coordinates on the left, with lines to where they belong. Places in px from the middle of the panel.
if (has_place) {
    labels = labels + 1
    label_text[labels] = '(x, z)'; label_x[labels] = place_x + 0.07*size; label_y[labels] = place_y + 0.03*size; label_ink[labels] = 0
    of_x[labels] = place_x; of_y[labels] = place_y
}
array at_x[40]; array at_y[40]; array half_width[40]
half_height = 9
crowded = labels > 9
column = 0.5*scale*(high_x - low_x) + 110
do for [i=1:labels] {
    at_x[i] = scale*(label_x[i] - middle_x)
    at_y[i] = scale*((crowded ? of_y[i] : label_y[i]) - middle_y)
    half_width[i] = 4.2*strlen(label_text[i]) + 4
    if (crowded) { at_x[i] = (label_ink[i] == 0 ? -1 : 1)*at_most(column + half_width[i], 0.5*side - half_width[i]) }
}
over_x(i, j) = half_width[i] + half_width[j] - abs(at_x[i] - at_x[j])
over_y(i, j) = 2*half_height - abs(at_y[i] - at_y[j])
do for [round=1:80] {
    do for [i=2:labels] {
        do for [j=1:i-1] {
            if (over_x(i, j) > 0 && over_y(i, j) > 0) {
                sideways = !crowded && over_x(i, j) < over_y(i, j)
                push = 0.25 + 0.5*(sideways ? over_x(i, j) : over_y(i, j))
                push = (sideways ? at_x[i] < at_x[j] : at_y[i] < at_y[j]) ? -push : push
                at_x[i] = at_x[i] + (sideways ? push : 0); at_x[j] = at_x[j] - (sideways ? push : 0)
                at_y[i] = at_y[i] + (sideways ? 0 : push); at_y[j] = at_y[j] - (sideways ? 0 : push)
            }
        }
    }
}
set style textbox opaque noborder margins 0.3,0.1
do for [i=1:labels] {
    x_at = middle_x + at_x[i]/scale
    y_at = middle_y + at_y[i]/scale
    if (crowded) {
        set arrow from x_at - sgn(at_x[i])*half_width[i]/scale, y_at to of_x[i], of_y[i] nohead lw 0.7 lc rgb ink[label_ink[i]+1] front
    }
    set label label_text[i] at x_at, y_at center font ',13' textcolor rgb ink[label_ink[i]+1] boxed front
}
bottom = middle_y - 0.5*height/scale
ground(x) = -fall*x > bottom ? -fall*x : bottom
plot '+' using 1:(ground($1)) with filledcurves y1=bottom fc rgb '#f0f0f0' notitle, \
    '+' using 1:(-fall*$1) with lines lw 2 lc rgb '#a0a0a0' notitle, \
    $segments using 1:2 with lines lw 3.4 lc rgb '#303030' notitle, \
    $zeros using 1:2 with lines dt 2 lw 1.2 lc rgb '#606060' notitle, \
    $segments using 1:2 with points pt 7 ps 0.7 lc rgb '#303030' notitle, \
    for [k=0:2] $arrows using 1:($5 == k && $6 == 0 ? $2 : NaN):3:4 with vectors nohead lw 2 lc rgb ink[k+1] notitle, \
    for [k=0:2] $arrows using 1:($5 == k && $6 == 1 ? $2 : NaN):3:4 with vectors head filled size screen 0.011,22 fixed \
        lw 2 lc rgb ink[k+1] notitle, \
    '+' using (has_place ? place_x : NaN):(place_y) every ::0::0 with points pt 6 ps 2 lw 2 lc rgb ink[1] notitle

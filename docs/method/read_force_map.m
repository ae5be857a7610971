% Forces, N, of a map that asperity has written as CSV, at approaches and positions, m (Octave, Matlab).
%   F = read_force_map("map.csv", 1.2e-6, 3e-3)
% Between the points F^(2/3) is linear, in which a Hertzian contact is straight; outside of the map it is an error.
function F = read_force_map(file, approach, position)
  numbers = dlmread(file, ",", 1, 0);          % one line of heading
  positions = numbers(1, 2:end);               % m, along the path
  approaches = numbers(2:end, 1);              % m, positive closing
  forces = numbers(2:end, 2:end);              % N, pressing
  if any(approach(:) < approaches(1)) || any(approach(:) > approaches(end))
    error("approach outside of the map: %g to %g m", approaches(1), approaches(end));
  end
  if any(position(:) < positions(1)) || any(position(:) > positions(end))
    error("position outside of the map: %g to %g m", positions(1), positions(end));
  end
  straight = sign(forces) .* abs(forces) .^ (2 / 3);
  found = interp2(positions, approaches, straight, position, approach, "linear");
  F = sign(found) .* abs(found) .^ 1.5;
end

!> Temperatures within triangles, with the profiles in the layers.
module heat_field
   use base_kinds, only: ik, rk
   use base_lists, only: inverted, lists_t
   use base_plane, only: barycentric, triangle_area
   use coarse_diffusion, only: corner_gradient, region_fluxes
   use coarse_layer_profiles, only: profile_t
   use coarse_layout, only: layer_block
   use heat_model, only: heat_model_t
   use mesh_geometry, only: cell_area
   implicit none(type, external)
   private

   public :: heat_field_t, moments, new_field

   type :: heat_field_t
      real(rk), allocatable :: acting(:)  !< (unknowns) temperatures of the field [K]
      real(rk), allocatable :: nodal(:)  !< (nodes) without the profiles [K]
      type(lists_t) :: near  !< layers at each node
      type(lists_t) :: around  !< those at the nodes of each cell, and
      type(profile_t), allocatable :: profile(:)  !< (items) their profiles in it [K]
      real(rk), allocatable :: tilt(:)  !< (items) their slopes along the faces [K/m]
      real(rk), allocatable :: least(:)  !< (cells) what matters in the mean of each [K]
      !> (cells) what the mean temperature leaves of the profiles, whose integral is not found where
      !! a front is very thin [-]
      real(rk), allocatable :: found(:)
      !> (cells) mean temperature less that of nodal values and profiles, which are less accurate
      !! where a front passes from the layers to the cells; 0 at tips, round which only the profiles
      !! go [K]
      real(rk), allocatable :: lack(:)
      ! As coarse_layers has pressures:
      real(rk), allocatable :: unknowns(:, :)  !< (3, blocks) [K]
      real(rk), allocatable :: inner(:, :)  !< (n_nodes - 1, layers) [K]
   end type heat_field_t

contains

   !> The field of temperatures above those of the sides' datum.
   function new_field(heat, temperature, means) result(field)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk), intent(in) :: means(:)  !< (cells) [K]
      type(heat_field_t) :: field
      real(rk), parameter :: thin = 0.05_rk  ! of a cell
      real(rk) :: beyond, largest, plain
      integer(ik) :: c, k, l

      associate (mesh => heat%mesh, layers => heat%layers)
         field%acting = temperature
         field%nodal = nodal_values(heat, temperature)
         field%unknowns = reshape(merge(temperature(max(heat%of_scalar, 1_ik)), 0.0_rk, &
                                        heat%of_scalar > 0), [3, size(heat%of_scalar)/3])
         allocate (field%inner(max(layers%n_nodes - 1, 0_ik), layers%n), source=0.0_rk)
         do l = 1, layers%n
            k = heat%first_node(l)
            associate (n => layers%chain(l)%n)
               field%inner(:n - 1, l) = temperature(k:k + n - 2)
               ! Half the difference between its ends is no unknown of heat.
               field%unknowns(2, layer_block(mesh, l)) = 0.0_rk
            end associate
         end do
         ! Without layers there is no list of their faces.
         field%near = inverted(mesh%face_nodes(:, [(mesh%layer_face(l), l=1, layers%n)]), &
                               mesh%n_nodes)
         call set_profiles(heat, temperature, field)
         largest = maxval(abs(temperature))
         field%least = 0.02_rk*max(abs(means), 1.0e-3_rk*largest)
         allocate (field%found(mesh%n_cells), source=1.0_rk)
         allocate (field%lack(mesh%n_cells), source=0.0_rk)
         do c = 1, mesh%n_cells
            associate (nodes => mesh%cell_nodes(:, c))
               plain = sum(field%nodal(nodes))/3.0_rk
               beyond = 0.0_rk
               if (field%around%length(c) > 0) then
                  beyond = sum(moments(heat, field, mesh%xy(:, nodes), c)) - plain
               end if
               if (abs(means(c)) < thin*largest .and. abs(beyond) > 0.0_rk) then
                  field%found(c) = max(0.0_rk, min(1.0_rk, (means(c) - plain)/beyond))
               end if
               if (any([(any(mesh%fracture%tip_node == nodes(k)), k=1, 3)])) cycle
               field%lack(c) = means(c) - plain - field%found(c)*beyond
            end associate
         end do
      end associate
   end function new_field

   !> Set the profiles around each cell. Along its face a profile has the slope of the nodal values,
   !! at most that between the layers next to it.
   subroutine set_profiles(heat, temperature, field)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      type(heat_field_t), intent(inout) :: field
      real(rk) :: slope(heat%layers%n)  ! from the first end of each face to the second [K/m]
      integer(ik), allocatable :: among(:)
      integer(ik) :: c, i, k, n

      associate (mesh => heat%mesh, near => field%near, around => field%around)
         n = sum([((near%length(mesh%cell_nodes(k, c)), k=1, 3), c=1, mesh%n_cells)])
         allocate (around%first(mesh%n_cells + 1), around%item(n), field%profile(n), &
                   field%tilt(n))
         slope = heat%slopes%ends(heat%layers, heat%first_node, temperature)/heat%slopes%reach
         n = 0
         do c = 1, mesh%n_cells
            around%first(c:c + 1) = n + 1
            associate (nodes => mesh%cell_nodes(:, c))
               if (all([(near%length(nodes(k)), k=1, 3)] == 0)) cycle
               among = [(near%of(nodes(k)), k=1, 3)]
               do i = 1, size(among, kind=ik)
                  if (any(among(:i - 1) == among(i))) cycle
                  n = n + 1
                  around%item(n) = among(i)
                  associate (profile => field%profile(n), corners => mesh%xy(:, nodes), &
                             ends => mesh%xy(:, mesh%face_nodes(:, &
                                                                mesh%layer_face(among(i)))))
                     call profile%place(heat%layers, among(i), mesh, mesh%fracture%tip_node)
                     field%tilt(n) = less(dot_product(field%nodal(nodes), &
                                                      barycentric(corners, corners(:, 1) &
                                                                  + profile%ahead) &
                                                      - [1.0_rk, 0.0_rk, 0.0_rk]), &
                                          sign(slope(among(i)), slope(among(i)) &
                                               *dot_product(profile%ahead, &
                                                            ends(:, 2) - ends(:, 1))))
                     call profile%set_values(heat%layers, among(i), field%unknowns, field%inner, &
                                             corners, field%nodal(nodes) - field%tilt(n) &
                                             *[(from_middle(profile, corners(:, k)), k=1, 3)])
                  end associate
               end do
            end associate
            around%first(c + 1) = n + 1
         end do
      end associate
   end subroutine set_profiles

   !> The smaller one of two slopes; none where they differ in sign.
   pure real(rk) function less(a, b)
      real(rk), intent(in) :: a, b

      less = 0.0_rk
      if (a*b > 0.0_rk) less = sign(min(abs(a), abs(b)), a)
   end function less

   !> How far ahead of the middle of its face a point is [m].
   pure real(rk) function from_middle(profile, xy)
      type(profile_t), intent(in) :: profile
      real(rk), intent(in) :: xy(2)  !< [m]

      from_middle = dot_product(xy - profile%start, profile%ahead) + 0.5_rk*profile%length
   end function from_middle

   !> Temperatures at nodes: the mean of what the multi-point fluxes extrapolate from the cells, or
   !! with layers from the rests of them.
   function nodal_values(heat, temperature) result(nodal)
      class(heat_model_t), intent(in) :: heat
      real(rk), intent(in) :: temperature(:)  !< (unknowns) [K]
      real(rk), allocatable :: nodal(:)  !< (nodes) [K]
      real(rk) :: gradient(2), number(heat%mesh%n_nodes)
      real(rk), allocatable :: flux(:), scalars(:)
      integer(ik) :: c, cell, k, r

      scalars = heat%scalars(temperature)
      allocate (nodal(heat%mesh%n_nodes), source=0.0_rk)
      number = 0.0_rk
      associate (mesh => heat%mesh, regions => heat%regions)
         do r = 1, regions%n_regions
            flux = spread(0.0_rk, 1, int(regions%flow_faces%length(r)))
            call region_fluxes(regions, regions%flux, scalars, r, flux)
            do c = 1, regions%cell_count(r)
               cell = regions%blocks%at(r, c)
               k = findloc(regions%regions_of_block(:, cell), r, dim=1)
               call corner_gradient(mesh, heat%rock%resistivity, regions, flux, cell, k, gradient)
               associate (v => mesh%cell_nodes(k, cell))
                  number(v) = number(v) + 1.0_rk
                  nodal(v) = nodal(v) + temperature(cell) &
                             + dot_product(gradient, mesh%xy(:, v) - heat%place(:, cell))
               end associate
            end do
         end do
      end associate
      nodal = nodal/number
   end function nodal_values

   !> Means of the temperature in a triangle within a cell, each weighted with the area coordinate
   !! of one corner: the temperature without profiles is linear, that of the profiles is integrated
   !! over parts, quadratic in each, which are divided where it is not.
   function moments(heat, field, xy, cell) result(moment)
      type(heat_model_t), intent(in) :: heat
      type(heat_field_t), intent(in) :: field
      real(rk), intent(in) :: xy(2, 3)  !< corners [m]
      integer(ik), intent(in) :: cell
      real(rk) :: moment(3)  !< [K]
      integer, parameter :: most = 7  ! times the cell is divided
      integer :: fewest  ! times the triangle is: once, unless it is small
      real(rk), parameter :: whole(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
      real(rk) :: plain(3)  ! without profiles
      real(rk) :: smallest  ! part, over the triangle
      integer(ik) :: k

      associate (nodes => heat%mesh%cell_nodes(:, cell))
         plain = [(dot_product(field%nodal(nodes), barycentric(heat%mesh%xy(:, nodes), xy(:, k))), &
                   k=1, 3)]
      end associate
      moment = (sum(plain) + plain)/12.0_rk + field%lack(cell)/3.0_rk
      smallest = 0.25_rk**most*cell_area(heat%mesh, cell)/max(tiny(1.0_rk), triangle_area(xy))
      fewest = merge(1, 0, smallest < 0.25_rk**(most - 2))
      if (field%around%length(cell) > 0) call add_part(whole, [(beyond(whole(:, k)), k=1, 3)], 0)

   contains

      recursive subroutine add_part(corner, value, times)
         real(rk), intent(in) :: corner(3, 3)  !< area coordinates of the corners, in columns
         real(rk), intent(in) :: value(3)  !< there [K]
         integer, intent(in) :: times
         real(rk) :: centre(3), middle(3, 3), of_centre, of_middle(3)
         integer(ik) :: a

         centre = sum(corner, dim=2)/3.0_rk
         of_centre = beyond(centre)
         associate (area => 0.25_rk**times)
            if (times >= fewest .and. &
                (area <= smallest .or. area*abs(of_centre - sum(value)/3.0_rk) &
                 <= field%least(cell))) then
               moment = moment + field%found(cell)*area*(0.75_rk*of_centre*centre &
                                                         + matmul(corner, value)/12.0_rk)
               return
            end if
         end associate
         middle = 0.5_rk*(corner + cshift(corner, 1, dim=2))  ! after each corner
         of_middle = [(beyond(middle(:, a)), a=1, 3)]
         call add_part(middle, of_middle, times + 1)
         do a = 1, 3
            associate (before => modulo(a - 2, 3_ik) + 1)
               call add_part(reshape([corner(:, a), middle(:, a), middle(:, before)], [3, 3]), &
                             [value(a), of_middle(a), of_middle(before)], times + 1)
            end associate
         end do
      end subroutine add_part

      !> What the profiles add at a point, on the edge of the triangle just within it [K].
      real(rk) function beyond(share)
         real(rk), intent(in) :: share(3)  !< area coordinates [-]
         real(rk), parameter :: inwards = 1.0e-6_rk
         real(rk) :: at(3), depth, nearest, point(2)
         integer(ik) :: best, i

         at = share + inwards*(1.0_rk/3.0_rk - share)
         point = matmul(xy, at)
         nearest = huge(1.0_rk)
         best = 0
         do i = field%around%first(cell), field%around%last(cell)
            depth = field%profile(i)%depth(point)
            if (depth > min(field%profile(i)%height, nearest)) cycle
            nearest = depth
            best = i
         end do
         beyond = 0.0_rk
         if (best > 0) beyond = field%profile(best)%pressure_at(point, nearest) + field%tilt(best) &
                               & *from_middle(field%profile(best), point) - dot_product(plain, at)
      end function beyond

   end function moments

end module heat_field
